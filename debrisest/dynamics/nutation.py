"""Rates of a torque-free rigid body in closed form, for any moments and any rate.

The textbook form (Biondi et al. 2017, Eq 3) holds for ``J1 > J2 > J3`` and ``L^2 < 2 T J2`` only,
and solves for a phase that equal moments and steady spins leave undefined. Here the addition
theorem of the elliptic functions carries the initial rates themselves, and no case is special.
"""

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.dynamics.elliptic import Modulus, elliptic, modulus_of

_SLOWEST = 1e-150  # rad/s, the frequency of a body that does not nutate
_SMALLEST_COMPLEMENT = 1e-290  # of the squared modulus, where half a period is endless


@dataclass(frozen=True)
class Nutation:
    """Rates ``(..., 3)`` in ``order``: multiples of ``dn``, ``sn`` and ``cn`` of one phase.

    The order of the axes is: the one that the rate circles, whose component keeps its sign, the
    intermediate one, the other extreme; with it ``w_a' = slope_a w_b w_c``, and cyclically.
    ``complement`` is ``1 - k^2``. ``dn2`` and ``k2_sn2`` are ``dn^2`` and ``k^2 sn^2`` of the
    initial phase; they add up to 1.
    """

    axes: Array
    """In ``order`` as unit vectors ``(..., 3, 3)``, a row each."""
    moments: Array
    rate0: Array
    slope: Array
    frequency: Array
    complement: Array
    dn2: Array
    k2_sn2: Array

    def of(self, some: BoolArray) -> "Nutation":
        """Return the nutation of some of the bodies."""
        return Nutation(*(getattr(self, field.name)[some] for field in fields(self)))

    @cached_property
    def modulus(self) -> Modulus:
        """What the elliptic functions need of the complement."""
        return modulus_of(self.complement)

    @property
    def period(self) -> Array:
        """Period ``(..., 1)`` of the component about the circled axis, s."""
        return 2.0 * self.modulus.quarter / self.frequency

    @property
    def momentum0(self) -> Array:
        """Angular momentum ``(..., 3)`` in ``order``."""
        return self.moments * self.rate0

    @property
    def side(self) -> Array:
        """Side ``(..., 1)`` of the circled axis on which rate and momentum stay, 1 or -1."""
        return np.copysign(1.0, self.rate0[..., :1])

    @property
    def hand(self) -> Array:
        """1 where the axes in ``order`` are right-handed, else -1 (..., 1)."""
        order = self.axes @ np.arange(3.0)
        return np.where((order[..., :1] + 1.0) % 3.0 == order[..., 1:2], 1.0, -1.0)

    def ordered_rate(self, times: Array) -> Array:
        """Rates ``(..., 3, time)`` in ``order``; their divisor is a sum of squares."""
        a, b, c = (self.rate0[..., [axis]] for axis in range(3))
        slope_a, slope_b, slope_c = (self.slope[..., [axis]] for axis in range(3))
        sn, cn, dn = elliptic(self.frequency * times, self.modulus)
        span = sn / self.frequency
        divisor = self.dn2 + self.k2_sn2 * cn * cn
        rates = np.empty((*divisor.shape[:-1], 3, divisor.shape[-1]))
        np.divide(a * dn + slope_a * b * c * span * cn, divisor, out=rates[..., 0, :])
        np.divide(b * cn * dn + slope_b * c * a * span, divisor, out=rates[..., 1, :])
        np.divide(c * cn + slope_c * a * b * span * dn, divisor, out=rates[..., 2, :])
        return rates


def nutation(rate0: Array, moments: Array) -> Nutation:
    """Nutation of bodies with principal ``moments`` and ``rate0``, both ``(..., 3)``.

    A body without rate about the circled axis spins steadily.
    """
    slope = (np.roll(moments, -1, axis=-1) - np.roll(moments, -2, axis=-1)) / moments
    axes = np.eye(3)[_axis_order(rate0, moments, slope)]
    rate0, moments, slope = np.moveaxis(axes @ np.stack([rate0, moments, slope], -1), -1, 0)
    around = -slope[..., 1] * slope[..., 2] * rate0[..., 0] ** 2
    across = slope[..., 0] * slope[..., 2] * rate0[..., 1] ** 2
    steady = around <= _SMALLEST_COMPLEMENT * across
    square = np.where(steady, 1.0, around + across)
    complement = np.maximum(_gap(rate0, slope) / square, _SMALLEST_COMPLEMENT)
    return Nutation(
        axes=axes,
        moments=moments,
        rate0=rate0,
        slope=slope,
        frequency=np.where(steady, _SLOWEST, np.sqrt(square))[..., None],
        complement=np.where(steady, 1.0, complement)[..., None],
        dn2=np.where(steady, 1.0, around / square)[..., None],
        k2_sn2=np.where(steady, 0.0, across / square)[..., None],
    )


def _axis_order(rate0: Array, moments: Array, slope: Array) -> IntArray:
    order = np.argsort(moments, axis=-1)
    rate0, slope = (np.take_along_axis(values, order, axis=-1) for values in (rate0, slope))
    return np.asarray(np.where(_gap(rate0, slope)[..., None] < 0.0, order[..., ::-1], order))


def _gap(rate: Array, slope: Array) -> Array:
    """Squared frequency times ``1 - k^2``; negative if the first axis is not the circled one."""
    return np.asarray(
        slope[..., 1] * slope[..., 0] * rate[..., 2] ** 2
        - slope[..., 1] * slope[..., 2] * rate[..., 0] ** 2
    )
