"""Normal equations of weighted rows, of any, and of points that share the errors of a motion."""

from math import prod

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.replay_model import PointRows


def normal_equations(
    derivative: Array, residual: Array, weight: Array
) -> tuple[Array, Array, Array]:
    """``H^T W H``, ``H^T W r`` and ``r^T W r`` per run, of rows ``(run, ..., m, n_e)``."""
    runs, rows, n_e = len(derivative), prod(residual.shape[1:]), derivative.shape[-1]
    flat = (weight[..., None] * derivative).reshape(runs, rows, n_e)
    weighted = (weight * residual).reshape(runs, rows, 1)
    transposed = np.swapaxes(flat, -1, -2)
    return transposed @ flat, (transposed @ weighted)[..., 0], (weighted**2).sum((-2, -1))


def point_equations(
    rows: PointRows, residual: Array, weight: Array, scale: Array
) -> tuple[Array, Array, Array]:
    """The same, point by point, of rows whose derivative is yet to be multiplied by ``scale``."""
    runs, epochs, points, each, own = rows.by_point.shape
    n_c, of_points = own - 3, points * each
    weighted = weight * residual
    factor = scale[..., :of_points].reshape(runs, epochs, points, each, 1)
    scaled = np.empty((runs, points, epochs, each, own))
    np.multiply(np.swapaxes(rows.by_point, 1, 2), np.swapaxes(factor, 1, 2), out=scaled)
    flat = scaled.reshape(runs, points, epochs * each, own)
    left = np.swapaxes(weighted[..., :of_points].reshape(runs, epochs, points, each), 1, 2)
    transposed = np.swapaxes(flat, -1, -2)
    square = transposed @ flat
    right = (transposed @ left.reshape(runs, points, epochs * each, 1))[..., 0]
    information = _assembled(square, n_c)
    gradient = np.concatenate([right[..., :n_c].sum(1), right[..., n_c:].reshape(runs, -1)], -1)
    if residual.shape[-1] > of_points:
        left, factor = weighted[..., of_points:], scale[..., of_points:, None]
        rest = normal_equations(factor * rows.by_rest, left, np.ones_like(left))
        information[:, :n_c, :n_c] += rest[0]
        gradient[:, :n_c] += rest[1]
    return information, gradient, (weighted**2).sum((-2, -1))


def _assembled(square: Array, n_c: int) -> Array:
    """Information ``(run, n_e, n_e)`` of all errors, from that of each point (run, N, own, own)."""
    runs, points = square.shape[:2]
    whole = np.zeros((runs, n_c + 3 * points, n_c + 3 * points))
    whole[:, :n_c, :n_c] = square[..., :n_c, :n_c].sum(1)
    for i in range(points):
        block = slice(n_c + 3 * i, n_c + 3 * i + 3)
        whole[:, block, block] = square[:, i, n_c:, n_c:]
        whole[:, :n_c, block] = square[:, i, :n_c, n_c:]
        whole[:, block, :n_c] = square[:, i, n_c:, :n_c]
    return whole
