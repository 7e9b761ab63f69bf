"""What people ask of a tumbling body, from the unknowns of its arc, each with its sigma.

All that depends on principal axes is undefined where two moments are too close for the data to
tell them apart: such numbers are NaN, and the sigma of the axis says why.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.batch.arc import INERTIA, UNKNOWNS, Arc, displaced
from debrisest.batch.observability import lost_directions
from debrisest.dynamics import log_inertia
from debrisest.dynamics.nutation import nutation

LOOSEST_AXIS = np.radians(10.0)
"""Sigma of a direction from which on it is undefined."""
_LOOSEST_SHARE = 0.5  # sigma of a number over itself
_SIDES = ((1, 2), (2, 0), (0, 1))  # about which a principal axis pair turns
_STEP = 1e-6
_BOTH = np.eye(UNKNOWNS), -np.eye(UNKNOWNS)
_LEAST_GAP = 1e-12


class Quantity(NamedTuple):
    """A number or some, with standard deviations; NaN where the data leave it undefined."""

    value: Array
    sigma: Array


class Derived(NamedTuple):
    """Quantities that follow from an arc, angles in rad."""

    axes: Quantity
    """Principal axes as columns in ``f`` (3, 3), moments ascending; the sigma (3,) of each axis is
    that of its direction."""
    moments: Quantity
    """Principal moments over the largest (3,), ascending."""
    axis_rates: Quantity
    """Rates about the principal axes at the arc's epoch (3,), rad/s."""
    momentum: Quantity
    """Direction of the angular momentum, inertial (3,)."""
    spin_axis: Quantity
    """Direction of the rate at the epoch, inertial (3,)."""
    speed: Quantity
    """Rate at the epoch, rad/s."""
    nutation_angle: Quantity
    """Between the angular momentum and the axis it circles in the body, at the epoch."""
    nutation_period: Quantity
    """After which the rate in the body is the same again, s."""


def derived(arc: Arc, covariance: Array) -> Derived:
    """Return what follows from an arc and the covariance (11, 11) of its unknowns."""
    tensor = log_inertia.inertia(arc.log_inertia)
    moments, axes = np.linalg.eigh(tensor)
    axes = axes * np.sign(np.linalg.det(axes))
    tilt = _axis_sigmas(moments, axes, covariance)
    lost = lost_directions(covariance) > 0
    vague = (tilt > LOOSEST_AXIS) | (lost & (tilt > 0.1 * LOOSEST_AXIS))
    beside = displaced(arc, _STEP * np.concatenate([np.zeros((1, UNKNOWNS)), *_BOTH]))
    shares, share_sigma = _spread(_shares(beside), covariance)
    rates, rate_sigma = _spread(_axis_rates(beside, axes), covariance)
    nutates, nutate_sigma = _spread(_nutation(beside), covariance)
    shown = share_sigma < _LOOSEST_SHARE * np.abs(shares)
    unsure = ~(nutate_sigma < _LOOSEST_SHARE * np.abs(nutates))
    return Derived(
        Quantity(np.where(vague, np.nan, axes), tilt),
        Quantity(np.where(shown & ~lost, shares, np.nan), share_sigma),
        Quantity(np.where(vague, np.nan, rates), rate_sigma),
        _direction(_momentum(beside), covariance),
        _direction(quaternion.rotate(beside.q, beside.rate), covariance),
        Quantity(*_spread(np.linalg.norm(beside.rate, axis=-1, keepdims=True), covariance)),
        Quantity(np.where(unsure, np.nan, nutates)[:1], nutate_sigma[:1]),
        Quantity(np.where(unsure, np.nan, nutates)[1:], nutate_sigma[1:]),
    )


def _spread(values: Array, covariance: Array) -> tuple[Array, Array]:
    """Return numbers and their standard deviations, by central differences.

    ``values (arc, n)`` are those of the arc, and of arcs beside it, ahead and behind.
    """
    ahead, behind = np.split(values[1:], 2)
    derivative = ((ahead - behind) / (2.0 * _STEP)).T
    variance = np.sum((derivative @ covariance) * derivative, axis=-1)
    return values[0], np.sqrt(np.maximum(variance, 0.0))


def _direction(vectors: Array, covariance: Array) -> Quantity:
    """Return a unit vector and the sigma of its components, NaN if the angle is large."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    value, sigma = _spread(vectors / np.maximum(length, 1e-300), covariance)
    sure = np.linalg.norm(sigma) < LOOSEST_AXIS
    return Quantity(value if sure else np.full(3, np.nan), sigma)


def _axis_sigmas(moments: Array, axes: Array, covariance: Array) -> Array:
    """Standard deviations (3,) of the directions of the principal axes, rad.

    In the axes, a change ``dS`` of the log-inertia turns axes i and j by ``dS_ij / (l_j - l_i)``.
    """
    turned = axes.T @ log_inertia.BASIS @ axes
    logs = np.log(moments)
    variance = np.zeros(3)
    for i, j in _SIDES:
        change = turned[:, i, j] / max(abs(logs[j] - logs[i]), _LEAST_GAP)
        turn = change @ covariance[INERTIA, INERTIA] @ change
        variance[[i, j]] += turn
    return np.asarray(np.sqrt(variance))


def _shares(arc: Arc) -> Array:
    moments = np.linalg.eigvalsh(log_inertia.inertia(arc.log_inertia))
    return np.asarray(moments / moments[..., -1:])


def _axis_rates(arc: Arc, near: Array) -> Array:
    """Rates about the principal axes, with the signs of axes that are near to given ones."""
    _, axes = np.linalg.eigh(log_inertia.inertia(arc.log_inertia))
    signs = np.sign(np.sum(axes * near, axis=-2))
    return np.asarray(signs * _in_axes(axes, arc.rate))


def _in_axes(axes: Array, vector: Array) -> Array:
    return np.asarray((np.swapaxes(axes, -1, -2) @ vector[..., None])[..., 0])


def _momentum(arc: Arc) -> Array:
    body = (log_inertia.inertia(arc.log_inertia) @ arc.rate[..., None])[..., 0]
    return quaternion.rotate(arc.q, body)


def _nutation(arc: Arc) -> Array:
    """Angle between the momentum and the circled axis, rad, and the period, s."""
    moments, axes = np.linalg.eigh(log_inertia.inertia(arc.log_inertia))
    motion = nutation(_in_axes(axes, arc.rate), moments)
    momentum = np.abs(motion.momentum0)
    length = np.maximum(np.linalg.norm(momentum, axis=-1), 1e-300)
    angle = np.arccos(np.clip(momentum[..., 0] / length, 0.0, 1.0))
    return np.stack([angle, 2.0 * motion.period[..., 0]], axis=-1)
