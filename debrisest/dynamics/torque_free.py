"""Torque-free rotation of a rigid body in closed form, without special cases.

The textbook form (Biondi et al. 2017, Eq 3) holds for ``J1 > J2 > J3`` and ``L^2 < 2 T J2`` only,
and solves for a phase that equal moments leave undefined. Here the addition theorem of the elliptic
functions carries the initial rates themselves, for any order of the moments; and the attitude is a
turn about the angular momentum and a shortest arc between body directions that are never opposite.
"""

from dataclasses import dataclass

import numpy as np

from debrisest.arrays import Array, ComplexArray, IntArray
from debrisest.attitude import quaternion
from debrisest.dynamics.elliptic import elliptic, quarter_period

_TINY = 1e-150  # a frequency or an angular momentum that stands for zero


def torque_free(times: Array, q0: Array, rate0: Array, moments: Array) -> tuple[Array, Array]:
    """Attitude ``q_ib (..., time, 4)`` and rate ``(..., time, 3)``, rad/s, in principal axes.

    ``times (time,)``, s, count from the epoch of ``q0 (..., 4)`` and ``rate0 (..., 3)``; they may
    have any step, order and sign. ``moments (..., 3)`` are positive, of any scale and in any order.
    """
    shape = np.broadcast_shapes(q0.shape[:-1], rate0.shape[:-1], moments.shape[:-1])
    rate0, moments = np.broadcast_to(rate0, (*shape, 3)), np.broadcast_to(moments, (*shape, 3))
    order = _axis_order(rate0, moments)
    nutation = _nutation(_pick(rate0, order), _pick(_slopes(moments), order))
    ordered_rate = nutation.rate(times)
    rate = _pick(ordered_rate, np.argsort(order, axis=-1)[..., None, :])
    reference = np.where(np.arange(3) == order[..., :1], np.copysign(1.0, rate0), 0.0)
    turn = _precession(times, nutation, rate0, moments, reference)
    return _attitude(q0, rate0, rate, moments, reference, turn), rate


def _pick(array: Array, order: IntArray) -> Array:
    return np.take_along_axis(array, order, axis=-1)


def _slopes(moments: Array) -> Array:
    """``(J_j - J_k) / J_i``, with which ``w_i' = slope_i w_j w_k``."""
    return np.asarray((np.roll(moments, -1, axis=-1) - np.roll(moments, -2, axis=-1)) / moments)


def _axis_order(rate0: Array, moments: Array) -> IntArray:
    """Axes ``(..., 3)``: the one that the rate circles, the intermediate one, the other extreme."""
    order = np.argsort(moments, axis=-1)
    gap = _gap(_pick(rate0, order), _pick(_slopes(moments), order))
    return np.asarray(np.where(gap[..., None] < 0.0, order[..., ::-1], order))


def _gap(rate: Array, slope: Array) -> Array:
    """Squared frequency times ``1 - k^2``; negative if the first axis is not the circled one."""
    return np.asarray(
        slope[..., 1] * slope[..., 0] * rate[..., 2] ** 2
        - slope[..., 1] * slope[..., 2] * rate[..., 0] ** 2
    )


@dataclass(frozen=True)
class _Nutation:
    """Rates in the order of `_axis_order`: multiples of ``dn``, ``sn``, ``cn`` of one phase.

    ``dn2`` and ``k2_sn2`` are ``dn^2`` and ``k^2 sn^2`` of the initial phase; they add up to 1.
    """

    rate0: Array
    slope: Array
    frequency: Array
    complement: Array
    dn2: Array
    k2_sn2: Array

    def rate(self, times: Array) -> Array:
        """Rates ``(..., time, 3)`` by the addition theorem; its divisor is a sum of squares."""
        a, b, c = np.moveaxis(self.rate0, -1, 0)[..., None]
        slope_a, slope_b, slope_c = np.moveaxis(self.slope, -1, 0)[..., None]
        sn, cn, dn = elliptic(self.frequency * times, self.complement)
        span = sn / self.frequency
        sums = [
            a * dn + slope_a * b * c * span * cn,
            b * cn * dn + slope_b * c * a * span,
            c * cn + slope_c * a * b * span * dn,
        ]
        return np.stack(sums, axis=-1) / (self.dn2 + self.k2_sn2 * cn * cn)[..., None]

    @property
    def half_period(self) -> Array:
        """Period ``(..., 1)`` of the circled component, s."""
        return 2.0 * quarter_period(self.complement) / self.frequency


def _nutation(rate0: Array, slope: Array) -> _Nutation:
    """A body without rate along the circled axis spins steadily: its frequency is taken as zero."""
    around = -slope[..., 1] * slope[..., 2] * rate0[..., 0] ** 2
    across = slope[..., 0] * slope[..., 2] * rate0[..., 1] ** 2
    steady = around == 0.0
    square = np.where(steady, 1.0, around + across)
    complement = np.where(steady, 1.0, np.maximum(_gap(rate0, slope) / square, 1e-290))
    return _Nutation(
        rate0=rate0,
        slope=slope,
        frequency=np.where(steady, _TINY, np.sqrt(square))[..., None],
        complement=complement[..., None],
        dn2=np.where(steady, 1.0, around / square)[..., None],
        k2_sn2=np.where(steady, 0.0, across / square)[..., None],
    )


def _precession(
    times: Array, nutation: _Nutation, rate0: Array, moments: Array, reference: Array
) -> Array:
    """Turn about the angular momentum, ``(..., time)``, rad.

    Its rate ``(2 T + L w_a) / (L + J_a w_a)`` is smooth and has the period of the circled
    component ``w_a``, so that its Fourier series can be integrated term by term.
    """
    momentum = np.maximum(np.linalg.norm(moments * rate0, axis=-1), _TINY)[..., None]
    energy2 = np.sum(moments * rate0**2, axis=-1)[..., None]
    moment = np.sum(moments * np.abs(reference), axis=-1)[..., None]
    period = nutation.half_period
    count = _sample_count(nutation.complement)
    circled = np.abs(nutation.rate(period * np.arange(count) / count)[..., 0])
    speed = (energy2 + momentum * circled) / (momentum + moment * circled)
    return _integrate_periodic(np.fft.rfft(speed, norm="forward"), period, times)


def _sample_count(complement: Array) -> int:
    """Samples of a period that bring the series below rounding: it falls as ``exp(-pi K'/K)``."""
    quarter = quarter_period(complement)
    return int(np.ceil(14.0 * np.max(quarter, initial=2.0, where=np.isfinite(quarter))))


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


def _attitude(
    q0: Array, rate0: Array, rate: Array, moments: Array, reference: Array, turn: Array
) -> Array:
    """``q_ib``: the momentum's body direction to the reference axis, the turn, then to inertial."""
    half = 0.5 * turn[..., None]
    about = np.concatenate([np.cos(half), np.sin(half) * reference[..., None, :]], axis=-1)
    start = _shortest_arc(moments * rate0, reference)
    arc = _shortest_arc(moments[..., None, :] * rate, reference[..., None, :])
    to_inertial = quaternion.multiply(q0, quaternion.conjugate(start))
    return quaternion.multiply(to_inertial[..., None, :], quaternion.multiply(about, arc))


def _shortest_arc(vector: Array, direction: Array) -> Array:
    """Unit quaternion that turns ``vector`` into ``direction``, which is not opposite to it."""
    norm = np.maximum(np.linalg.norm(vector, axis=-1, keepdims=True), _TINY)
    scalar = 1.0 + np.sum(vector * direction, axis=-1, keepdims=True) / norm
    return quaternion.normalize(np.concatenate([scalar, np.cross(vector / norm, direction)], -1))
