"""The closed form of torque-free rotation as plain loops over one body, for `debrisest.compiled`.

The formulas are those of `torque_free`, `nutation` and `elliptic`, where their words are.
"""

import math
from typing import Any

import numpy as np

from debrisest.arrays import Array, ComplexArray, IntArray
from debrisest.attitude.rotation_loops import Quaternion
from debrisest.compiled import compiled
from debrisest.dynamics.sine_loops import sines

Body = tuple[Any, ...]
_SAMPLES = 16  # of half a period, at first
_SMALLEST_TERM = 1e-15  # of the precession, of its mean rate
_MOST = 24  # Landen transformations and steps of means, of which a handful is needed


@compiled
def body_of(rate0: Array, moments: Array) -> Body:
    """Return what the motion of ``rate0 (3)`` and ``moments (3)`` is made of, axes in order."""
    slopes, order = _slopes(moments), _ascending(moments)
    rate, moment, slope = rate0[order], moments[order], slopes[order]
    if _gap(rate, slope) < 0.0:
        order = order[::-1].copy()
        rate, moment, slope = rate[::-1].copy(), moment[::-1].copy(), slope[::-1].copy()
    around = -slope[1] * slope[2] * rate[0] ** 2
    across = slope[0] * slope[2] * rate[1] ** 2
    shape = np.array([1e-150, 1.0, 1.0, 0.0])  # frequency, complement, dn^2, k^2 sn^2
    if not around <= 1e-290 * across:
        square = around + across
        shape[0] = math.sqrt(square)
        shape[1] = max(_gap(rate, slope) / square, 1e-290)
        shape[2], shape[3] = around / square, across / square
    quarter = _quarter_period(shape[1])
    moduli = _landen_moduli(shape[1])
    momentum = max(math.sqrt(np.sum((moment * rate) ** 2)), 1e-150)
    side = math.copysign(1.0, rate[0])
    hand = 1.0 if (order[0] + 1) % 3 == order[1] else -1.0
    motion = (rate, slope, shape, quarter, moduli)
    harmonics = _harmonics(motion, moment, momentum, side)
    return (motion, harmonics, moment / momentum, side, hand, order)


@compiled
def at(times: Array, body: Body, rate: Array, about: Array) -> None:
    """Write rate (3, time) and attitude (4, time) about the momentum, in the order of the axes.

    ``times (time,)``, s, count from the epoch.
    """
    motion, harmonics, by_rate, side, hand, _ = body
    _rates(times, motion, rate)
    _half_turned(times, harmonics, 2.0 * motion[3] / motion[2][0], about)
    sines(about[0], about[3], about[2])
    for t in range(len(times)):
        cos, sin = about[2, t], about[3, t]
        cosine = math.sqrt(0.5 + 0.5 * side * by_rate[0] * rate[0, t])
        b = 0.5 * by_rate[1] * rate[1, t] / cosine
        c = 0.5 * by_rate[2] * rate[2, t] / cosine
        about[0, t], about[1, t] = cos * cosine, side * sin * cosine
        cos *= side * hand
        about[2, t], about[3, t] = sin * b + cos * c, sin * c - cos * b


@compiled
def at_epoch(body: Body) -> Quaternion:
    """Attitude about the momentum at the epoch, in the order of the axes."""
    motion, _, by_rate, side, hand, _ = body
    rate = motion[0]
    cosine = math.sqrt(0.5 + 0.5 * side * by_rate[0] * rate[0])
    half = 0.5 * side * hand / cosine
    return cosine, 0.0, half * by_rate[2] * rate[2], -half * by_rate[1] * rate[1]


@compiled
def _ascending(moments: Array) -> IntArray:
    """The order (3) of three numbers."""
    order = np.arange(3)
    for i, j in ((0, 1), (1, 2), (0, 1)):
        if moments[order[j]] < moments[order[i]]:
            order[i], order[j] = order[j], order[i]
    return order


@compiled
def _gap(rate: Array, slope: Array) -> float:
    gap: float = slope[1] * slope[0] * rate[2] ** 2 - slope[1] * slope[2] * rate[0] ** 2
    return gap


@compiled
def _slopes(moments: Array) -> Array:
    slope = np.empty(3)
    for i in range(3):
        slope[i] = (moments[(i + 1) % 3] - moments[(i + 2) % 3]) / moments[i]
    return slope


@compiled
def _quarter_period(complement: float) -> float:
    """Complete integral K by the arithmetic and geometric means."""
    a, b = 1.0, math.sqrt(complement)
    for _ in range(_MOST):
        if not abs(a - b) > 1e-9 * a:
            break
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return math.pi / (a + b)


@compiled
def _landen_moduli(complement: float) -> Array:
    k_prime, moduli, count = math.sqrt(complement), np.empty((_MOST, 2)), 0
    while count < _MOST:
        moduli[count] = (1.0 - k_prime) / (1.0 + k_prime), 2.0 * k_prime / (1.0 + k_prime)
        k_prime = 2.0 * math.sqrt(k_prime) / (1.0 + k_prime)
        count += 1
        if not moduli[count - 1, 0] > 1e-9:
            break
    return moduli[:count]


@compiled
def _rates(times: Array, motion: Body, rate: Array) -> None:
    (a, b, c), (slope_a, slope_b, slope_c), shape, quarter, moduli = motion
    for t in range(len(times)):
        angle = shape[0] * times[t] / (4.0 * quarter)
        rate[0, t] = 2.0 * math.pi * (angle - np.rint(angle))
    sines(rate[0], rate[1], rate[2])
    rate[0] = 1.0
    for k in range(len(moduli) - 1, -1, -1):
        modulus, rest = moduli[k]
        for t in range(len(times)):
            dn, sn, cn = rate[0, t], rate[1, t], rate[2, t]
            per = 1.0 / (1.0 + modulus * sn * sn)
            rate[0, t] = (rest + modulus * cn * cn) * per
            rate[1, t], rate[2, t] = sn * (1.0 + modulus) * per, cn * dn * per
    for t in range(len(times)):
        dn, sn, cn = rate[0, t], rate[1, t], rate[2, t]
        span = sn / shape[0]
        per = 1.0 / (shape[2] + shape[3] * cn * cn)
        rate[0, t] = (a * dn + slope_a * b * c * span * cn) * per
        rate[1, t] = (b * cn * dn + slope_b * c * a * span) * per
        rate[2, t] = (c * cn + slope_c * a * b * span * dn) * per


@compiled
def _harmonics(motion: Body, moment: Array, momentum: float, side: float) -> tuple[float, Any]:
    """Mean of the precession's rate and the sums of its series, highest first.

    Samples are doubled until the highest terms vanish, or there are as many as numpy's code takes.
    """
    quarter = motion[3]
    most = 14 * math.ceil(max(quarter, 2.0) if math.isfinite(quarter) else 2.0)
    count = _SAMPLES
    mean, terms = _series(motion, moment, momentum, count)
    while count < most and not len(terms) < count // 2 - 1:
        count *= 2
        mean, terms = _series(motion, moment, momentum, count)
    tails = terms[::-1].copy()
    for k in range(1, len(tails)):
        tails[k] += tails[k - 1]
    return mean, tails


@compiled
def _series(motion: Body, moment: Array, momentum: float, count: int) -> tuple[float, ComplexArray]:
    """Mean of the precession's rate and the terms of its series, from so many samples."""
    rate0, _, shape, quarter, _ = motion
    work, twice_energy, mean = np.empty((11, count)), 0.0, 0.0
    rate, angle, cos, sin, speed = work[:3], work[3], work[4], work[5], work[6]
    for k in range(count):
        angle[k] = 2.0 * quarter / (shape[0] * count) * k
    _rates(angle, motion, rate)
    for k in range(count):
        angle[k] = 2.0 * math.pi / count * k
    sines(angle, sin, cos)
    for i in range(3):
        twice_energy += moment[i] * rate0[i] ** 2
    for k in range(count):
        circled = abs(rate[0, k])
        speed[k] = (twice_energy + momentum * circled) / (momentum + moment[0] * circled)
        mean += speed[k] / count
    return mean, _terms(speed, cos, sin, _SMALLEST_TERM * mean, work[7:])


@compiled
def _terms(speed: Array, cos: Array, sin: Array, least: float, work: Array) -> ComplexArray:
    """Terms of the integrated series, lowest first, down to those that are below rounding.

    Sine and cosine of all harmonics go from sample to sample together; ``work`` is room for them.
    """
    count = len(speed)
    c, s, real, imaginary = work[0], work[1], work[2], work[3]
    room = 8 * ((count // 2 + 7) // 8)
    for n in range(room):
        c[n], s[n], real[n], imaginary[n] = 1.0, 0.0, 0.0, 0.0
    for k in range(count):
        for n in range(room):
            real[n] += speed[k] * c[n]
            imaginary[n] -= speed[k] * s[n]
            ahead = c[n] * cos[n + 1] - s[n] * sin[n + 1]
            s[n] = s[n] * cos[n + 1] + c[n] * sin[n + 1]
            c[n] = ahead
    last = count // 2
    while last > 1 and abs(real[last - 1]) + abs(imaginary[last - 1]) < least * count:
        last -= 1
    terms = np.empty(last, dtype=np.complex128)
    for n in range(last):
        terms[n] = complex(real[n], imaginary[n]) * 2.0 / ((n + 1) * count)
    return terms


@compiled
def _half_turned(
    times: Array, harmonics: tuple[float, ComplexArray], period: float, about: Array
) -> None:
    """Write half the turn about the angular momentum since the epoch, rad, in the first row."""
    mean, tails = harmonics
    real, sin, cos, imaginary = about[0], about[1], about[2], about[3]
    for t in range(len(times)):
        real[t] = math.pi / period * times[t]
    sines(real, sin, cos)
    real[:], imaginary[:] = 0.0, 0.0
    for tail in tails:
        for t in range(len(times)):
            c, s = cos[t] * cos[t] - sin[t] * sin[t], 2.0 * sin[t] * cos[t]
            x, y = real[t], imaginary[t]
            real[t] = x * c - y * s + tail.real
            imaginary[t] = x * s + y * c + tail.imag
    half, scale = 0.5 * mean, 0.5 * period / math.pi
    for t in range(len(times)):
        waved = sin[t] * (cos[t] * real[t] - sin[t] * imaginary[t])
        real[t] = half * times[t] + scale * waved
