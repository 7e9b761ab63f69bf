"""Two parallel cameras with focal length 1 that look along y (x to the right, z up).

The first camera is in the origin; the second, which the paper calls the left one, at
``x = +baseline`` (and so is on the right). Source: Pesce et al. 2017, Eqs 22-29. Printed Eqs 24-27,
the flow of a point, belong to a camera that looks along z and to a point that turns about the
camera; here the flow is the derivative of the projection of the moving point. Eq 28 as printed,
``u_left - u_right``, is negative with Eq 23: it is kept, since only its sign is unusual.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array

PIXELS, FLOW, DISPARITY = slice(0, 4), slice(4, 8), slice(8, 9)
"""Rows of `measure`: ``u, v`` of both cameras, their time derivatives, the disparity."""
ROWS = 9


def measure(point: NDArray[Any], velocity: NDArray[Any], baseline: float) -> NDArray[Any]:
    """What both cameras show of points ``(..., 3)``, m, that move with ``velocity``: ``(..., 9)``.

    Position and velocity are in the camera's axes and relative to it. Angles are slopes, flow is
    per second; points must have ``y > 0`` to be in front.
    """
    x, y, z = point[..., 0], point[..., 1], point[..., 2]
    vx, vy, vz = velocity[..., 0], velocity[..., 1], velocity[..., 2]
    near = 1.0 / y
    right, left, up = x * near, (x - baseline) * near, z * near
    rise = (vz - up * vy) * near
    rows = [right, up, left, up]
    rows += [(vx - right * vy) * near, rise, (vx - left * vy) * near, rise, -baseline * near]
    return np.stack(rows, axis=-1)


def jacobian(point: Array, velocity: Array, baseline: float) -> Array:
    """Derivative ``(..., 9, 6)`` of `measure` with respect to position and velocity."""
    shown = measure(point, velocity, baseline)
    near = 1.0 / point[..., 1]
    recede = velocity[..., 1] * near
    result = np.zeros((*shown.shape, 6))
    for slope, flow, across in ((0, 4, 0), (1, 5, 2), (2, 6, 0), (3, 7, 2)):
        at = shown[..., slope]
        result[..., slope, across] = near
        result[..., slope, 1] = -at * near
        result[..., flow, across] = -recede * near
        result[..., flow, 1] = (at * recede - shown[..., flow]) * near
        result[..., flow, 3 + across] = near
        result[..., flow, 4] = -at * near
    result[..., 8, 1] = baseline * near**2
    return result


def depth(shown: Array, baseline: float) -> Array:
    """Distance along y (...,), m, from ``shown (..., 9)``: the mean of what there is.

    NaN where neither both pixels nor the disparity were observed.
    """
    pair = np.stack([shown[..., 0] - shown[..., 2], -shown[..., 8]], axis=-1)
    seen = ~np.isnan(pair)
    count = seen.sum(-1)
    total = np.where(seen, pair, 0.0).sum(-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(count > 0, baseline * count / total, np.nan))
