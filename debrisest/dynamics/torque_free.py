"""Torque-free rotation of a rigid body in closed form, without special cases.

The attitude is a turn about the angular momentum and a shortest arc between body directions that
are never opposite, so that no body and no motion is singular.
"""

import numpy as np

from debrisest.arrays import Array, ComplexArray, IntArray
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import cross
from debrisest.dynamics.elliptic import quarter_period
from debrisest.dynamics.nutation import Nutation, nutation

_AT_REST = 1e-150  # angular momentum that stands for none
_SAMPLES = 14  # of a period at a time


def torque_free(times: Array, q0: Array, rate0: Array, moments: Array) -> tuple[Array, Array]:
    """Attitude ``q_ib (..., time, 4)`` and rate ``(..., time, 3)``, rad/s, in principal axes.

    ``times (time,)``, s, count from the epoch of ``q0 (..., 4)`` and ``rate0 (..., 3)``; they may
    have any step, order and sign. ``moments (..., 3)`` are positive, of any scale and in any order.
    """
    shape = np.broadcast_shapes(q0.shape[:-1], rate0.shape[:-1], moments.shape[:-1])
    rate0, moments = np.broadcast_to(rate0, (*shape, 3)), np.broadcast_to(moments, (*shape, 3))
    motion = nutation(rate0, moments)
    rate = motion.reordered(motion.ordered_rate(times))
    circled = np.arange(3) == motion.order[..., :1]
    reference = np.where(circled, np.copysign(1.0, rate0), 0.0)
    turn = _precession(times, motion, rate0, moments)
    return _attitude(q0, moments * rate0, moments[..., None, :] * rate, reference, turn), rate


def _precession(times: Array, motion: Nutation, rate0: Array, moments: Array) -> Array:
    """Turn about the angular momentum, ``(..., time)``, rad.

    Its rate ``(2 T + L w_a) / (L + J_a w_a)`` is smooth and has the period of the circled
    component ``w_a``, so that its Fourier series can be integrated term by term.
    """
    counts = _sample_counts(motion.complement[..., 0])
    harmonics = np.zeros((*counts.shape, counts.max(initial=0) // 2 + 1), dtype=np.complex128)
    for count in np.unique(counts):
        some = counts == count
        speed = _speed(motion.of(some), rate0[some], moments[some], int(count))
        harmonics[some, : count // 2 + 1] = np.fft.rfft(speed, norm="forward")
    return _integrate_periodic(harmonics, motion.period, times)


def _speed(motion: Nutation, rate0: Array, moments: Array, count: int) -> Array:
    """Rate of the turn at so many times of a period, ``(..., count)``, rad/s."""
    momentum = np.maximum(np.linalg.norm(moments * rate0, axis=-1), _AT_REST)[..., None]
    twice_energy = np.sum(moments * rate0**2, axis=-1)[..., None]
    moment = np.take_along_axis(moments, motion.order[..., :1], axis=-1)
    circled = np.abs(motion.ordered_rate(motion.period * np.arange(count) / count)[..., 0])
    return np.asarray((twice_energy + momentum * circled) / (momentum + moment * circled))


def _sample_counts(complement: Array) -> IntArray:
    """Samples of a period that bring the series below rounding: it falls as ``exp(-pi K'/K)``.

    Each has as many as it would have alone, of a few numbers that runs share.
    """
    quarter = quarter_period(complement)
    needed = 14.0 * np.where(np.isfinite(quarter), np.maximum(quarter, 2.0), 2.0)
    return _SAMPLES * np.ceil(needed / _SAMPLES).astype(np.int64)


def _integrate_periodic(harmonics: ComplexArray, period: Array, times: Array) -> Array:
    """Integral from 0 to ``times`` of a real Fourier series ``(..., harmonic)``.

    ``z^j - 1`` is written as ``(z - 1)(1 + ... + z^(j-1))``: nothing cancels in a long period.
    """
    number = np.arange(1, harmonics.shape[-1])
    terms = 2.0 * harmonics[..., 1:] / number
    tails = np.cumsum(terms[..., ::-1], axis=-1)
    half_angle = np.pi * times / period
    z = np.exp(2j * half_angle)
    total = np.zeros_like(z)
    for tail in np.moveaxis(tails, -1, 0)[..., None]:
        total = total * z + tail
    chord = np.sin(half_angle) * period / np.pi * np.exp(1j * half_angle)
    return np.asarray(harmonics[..., :1].real * times + (chord * total).real)


def _attitude(q0: Array, momentum0: Array, momentum: Array, reference: Array, turn: Array) -> Array:
    """``q_ib``: the momentum's body direction to the reference axis, the turn, then to inertial."""
    half = 0.5 * turn[..., None]
    about = np.concatenate([np.cos(half), np.sin(half) * reference[..., None, :]], axis=-1)
    arc = _shortest_arc(momentum, reference[..., None, :])
    to_inertial = quaternion.multiply(q0, quaternion.conjugate(_shortest_arc(momentum0, reference)))
    return quaternion.multiply(to_inertial[..., None, :], quaternion.multiply(about, arc))


def _shortest_arc(vector: Array, direction: Array) -> Array:
    """Unit quaternion that turns ``vector`` into ``direction``, which is not opposite to it."""
    norm = np.maximum(np.linalg.norm(vector, axis=-1, keepdims=True), _AT_REST)
    scalar = 1.0 + np.sum(vector * direction, axis=-1, keepdims=True) / norm
    return quaternion.normalize(np.concatenate([scalar, cross(vector / norm, direction)], -1))
