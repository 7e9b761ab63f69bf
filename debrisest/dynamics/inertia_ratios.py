"""Ratios of principal moments of inertia, all that the torque-free rotation of a body shows.

``k = (ln(Ix/Iy), ln(Iy/Iz))`` (Pesce et al. 2017, Eq 32), arrays ``(..., 2)``, may take any value.
The slopes ``sx = (Iy-Iz)/Ix``, ``sy = (Iz-Ix)/Iy``, ``sz = (Ix-Iy)/Iz`` are the factors of the
rate products in Euler's equations. A real body obeys the triangle inequalities ``Ii + Ij > Ik``,
which say ``|s| < 1``; sx and sz together are a chart of the ratios in which the angular
acceleration about x and z is linear, and ``sy = -(sx + sz) / (1 + sx sz)`` follows.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array

LARGEST_SLOPE = 0.97
"""Slopes are kept below this: at 1 the body is a flat plate."""
LARGEST_CHANGE = 0.5
"""A single correction changes a slope by no more than this."""
LARGEST_START_SLOPE = 0.95
NOT_CUT = 1e-12


def ratios(moments: Array) -> Array:
    """``k (..., 2)`` of positive principal moments ``(..., 3)`` of any scale."""
    return np.asarray(np.log(moments[..., :2] / moments[..., 1:]))


def moments(k: NDArray[Any]) -> NDArray[Any]:
    """Principal moments ``(..., 3)``, scaled to ``Iy = 1`` (Eq 33)."""
    one = np.ones_like(k[..., 0])
    return np.stack([np.exp(k[..., 0]), one, np.exp(-k[..., 1])], axis=-1)


def slopes(k: NDArray[Any]) -> NDArray[Any]:
    """``sx, sy, sz (..., 3)``; `expm1` keeps all digits of nearly equal moments."""
    k1, k2 = k[..., 0], k[..., 1]
    sx = -np.expm1(-k2) * np.exp(-k1)
    sy = -np.expm1(k1 + k2) * np.exp(-k2)
    sz = np.expm1(k1) * np.exp(k2)
    return np.stack([sx, sy, sz], axis=-1)


def angular_acceleration(rate: NDArray[Any], k: NDArray[Any]) -> NDArray[Any]:
    """``-I^-1 (w x I w) (..., 3)``, rad/s^2, of body rates ``(..., 3)``: Eq 37 solved for it.

    All in principal axes; the printed equation leaves the frame open.
    """
    return np.asarray(slopes(k) * rate_products(rate))


def rate_products(rate: NDArray[Any]) -> NDArray[Any]:
    """``wy wz, wz wx, wx wy (..., 3)``."""
    result = np.empty_like(rate)
    x, y, z = rate[..., 0], rate[..., 1], rate[..., 2]
    result[..., 0], result[..., 1], result[..., 2] = y * z, z * x, x * y
    return result


def acceleration_by_rate(rate: Array, k: Array) -> Array:
    """Derivative ``(..., 3, 3)`` of `angular_acceleration` with respect to the rate."""
    x, y, z = np.moveaxis(rate, -1, 0)
    zero = np.zeros_like(x)
    columns = [zero, z, y, z, zero, x, y, x, zero]
    products = np.stack(columns, axis=-1).reshape(*x.shape, 3, 3)
    return np.asarray(slopes(k)[..., None] * products)


def acceleration_by_ratios(rate: Array, k: Array) -> Array:
    """Derivative ``(..., 3, 2)`` of `angular_acceleration` with respect to ``k``."""
    sx, _, sz = np.moveaxis(slopes(k), -1, 0)
    e1, inverse_e2 = np.exp(k[..., 0]), np.exp(k[..., 1])
    rows = [-sx, 1.0 / (e1 * inverse_e2), -e1, -1.0 / inverse_e2, e1 * inverse_e2, sz]
    by_k = np.stack(rows, axis=-1).reshape(*e1.shape, 3, 2)
    return np.asarray(rate_products(rate)[..., None] * by_k)


def from_slopes(slope: Array) -> Array:
    """``k (..., 2)`` of ``(sx, sz) (..., 2)``, each inside (-1, 1)."""
    sx, sz = slope[..., 0], slope[..., 1]
    k1 = np.log1p(sz) - np.log1p(sx * sz)
    k2 = np.log1p(sx * sz) - np.log1p(-sx)
    return np.stack([k1, k2], axis=-1)


def move(k: Array, change: Array) -> Array:
    """``k`` after a correction ``(..., 2)``, within the triangle inequalities.

    To first order the result is ``k + change``; the step is straight in the chart (sx, sz), where
    it is cut at `LARGEST_CHANGE` and at `LARGEST_SLOPE`.
    """
    slope = slopes(k)[..., ::2]
    rise = (slopes_by_ratios(k) @ change[..., None])[..., 0]
    return from_slopes(slope + _cut(slope, rise))


def excess(k: Array, change: Array) -> Array:
    """By how much `move` cuts a correction ``(..., 2)``, in sx and sz: what is made minus asked."""
    rise = (slopes_by_ratios(k) @ change[..., None])[..., 0]
    cut = _cut(slopes(k)[..., ::2], rise)
    return np.where(np.abs(cut - rise) > NOT_CUT, cut - rise, 0.0)


def slopes_by_ratios(k: Array) -> Array:
    """Derivative ``(..., 2, 2)`` of (sx, sz) with respect to ``k``."""
    sx, _, sz = np.moveaxis(slopes(k), -1, 0)
    product = np.exp(k[..., 0] + k[..., 1])
    return np.stack([-sx, 1.0 / product, product, sz], -1).reshape(*sx.shape, 2, 2)


def _cut(slope: Array, rise: Array) -> Array:
    rise = np.clip(rise, -LARGEST_CHANGE, LARGEST_CHANGE)
    return np.asarray(np.clip(slope + rise, -LARGEST_SLOPE, LARGEST_SLOPE) - slope)


def feasible(k: Array, limit: float = LARGEST_START_SLOPE) -> Array:
    """``k`` scaled down, where it has to be, until every slope is below ``limit``."""
    result = np.array(k)
    for _ in range(200):
        outside = ~(np.abs(slopes(result)).max(-1, initial=0.0) < limit) & np.isfinite(k).all(-1)
        if not outside.any():
            break
        result[outside] *= 0.9
    return result
