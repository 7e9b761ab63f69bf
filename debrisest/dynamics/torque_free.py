"""Torque-free rotation of a rigid body in closed form, without special cases.

The attitude is a turn about the angular momentum and a shortest arc between body directions that
are never opposite, so that no body and no motion is singular.
"""

import numpy as np

from debrisest.arrays import Array, ComplexArray, IntArray
from debrisest.attitude import quaternion
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
    rate = motion.ordered_rate(times)
    q_ib = _attitude(q0, motion, rate, _precession(times, motion))
    return q_ib, np.swapaxes(np.swapaxes(motion.axes, -1, -2) @ rate, -1, -2)


def _precession(times: Array, motion: Nutation) -> Array:
    """Turn about the angular momentum, ``(..., time)``, rad.

    Its rate ``(2 T + L w_a) / (L + J_a w_a)`` is smooth and has the period of the circled
    component ``w_a``, so that its Fourier series can be integrated term by term.
    """
    counts = _sample_counts(motion.modulus.quarter[..., 0])
    if counts.size and np.all(counts == counts.flat[0]):
        speed = _speed(motion, int(counts.flat[0]))
        return _integrate_periodic(np.fft.rfft(speed, norm="forward"), motion.period, times)
    harmonics = np.zeros((*counts.shape, counts.max(initial=0) // 2 + 1), dtype=np.complex128)
    for count in set(counts.ravel().tolist()):
        some = counts == count
        speed = _speed(motion.of(some), count)
        harmonics[some, : count // 2 + 1] = np.fft.rfft(speed, norm="forward")
    return _integrate_periodic(harmonics, motion.period, times)


def _speed(motion: Nutation, count: int) -> Array:
    """Rate of the turn at so many times of a period, ``(..., count)``, rad/s."""
    momentum = np.maximum(np.linalg.norm(motion.momentum0, axis=-1), _AT_REST)[..., None]
    twice_energy = np.sum(motion.momentum0 * motion.rate0, axis=-1)[..., None]
    samples = motion.period * np.arange(count) / count
    circled = np.abs(motion.ordered_rate(samples)[..., 0, :])
    return np.asarray(
        (twice_energy + momentum * circled) / (momentum + motion.moments[..., :1] * circled)
    )


def _sample_counts(quarter: Array) -> IntArray:
    """Samples of a period that bring the series below rounding: it falls as ``exp(-pi K'/K)``.

    Each has as many as it would have alone, of a few numbers that runs share.
    """
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
    sine, half = np.sin(half_angle), np.empty(half_angle.shape, dtype=np.complex128)
    half.real, half.imag = np.cos(half_angle), sine
    z, total = half * half, np.zeros_like(half)
    for tail in np.moveaxis(tails, -1, 0)[..., None]:
        total *= z
        total += tail
    chord = (sine * period / np.pi) * half
    return np.asarray(harmonics[..., :1].real * times + (chord * total).real)


def _attitude(q0: Array, motion: Nutation, rate: Array, turn: Array) -> Array:
    """``q_ib (..., time, 4)`` of the ``rate (..., 3, time)`` in order and the turn."""
    axes = np.zeros((*turn.shape[:-1], 4, 4))
    axes[..., 0, 0], axes[..., 1:, 1:] = 1.0, motion.axes
    start = _about_momentum(motion, motion.rate0[..., None], np.zeros((*turn.shape[:-1], 1)))
    inverse = quaternion.conjugate(np.sum(start * axes, axis=-2) / np.sum(start**2, axis=-2))
    to_inertial = quaternion.multiply(q0, inverse)[..., None, :]
    by = np.swapaxes(quaternion.multiply(to_inertial, axes), -1, -2)
    return np.swapaxes(by @ _about_momentum(motion, rate, turn), -1, -2)


def _about_momentum(motion: Nutation, rate: Array, turn: Array) -> Array:
    """Shortest arc of the momentum to the circled axis, then the turn, ``(..., 4, time)``.

    The arc ends on that side of the axis on which the momentum always is, which is never opposite.
    The vectors are in the axes in order. Of a body at rest all are shorter by the same factor.
    """
    norm = np.maximum(np.linalg.norm(motion.momentum0, axis=-1), _AT_REST)[..., None]
    by_rate = (motion.moments / norm)[..., None]
    cosine = np.sqrt(0.5 + 0.5 * motion.side * by_rate[..., 0, :] * rate[..., 0, :])
    b, c = (0.5 * by_rate[..., axis, :] * rate[..., axis, :] / cosine for axis in (1, 2))
    half = 0.5 * turn
    cos, sin = np.cos(half), np.sin(half)
    result = np.empty((*turn.shape[:-1], 4, turn.shape[-1]))
    np.multiply(cos, cosine, out=result[..., 0, :])
    np.multiply(motion.side * sin, cosine, out=result[..., 1, :])
    cos *= motion.side * motion.hand
    np.add(sin * b, cos * c, out=result[..., 2, :])
    np.subtract(sin * c, cos * b, out=result[..., 3, :])
    return result
