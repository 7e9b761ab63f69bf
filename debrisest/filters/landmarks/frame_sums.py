"""What frames add to the normal equations of a landmark model's cost.

Rows depend on the errors of their own epoch; what these are by the start's parameters comes last,
once for all rows of a frame.
"""

from typing import Any, NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray
from debrisest.filters.landmark_model import LandmarkModel, Observations, Rows
from debrisest.filters.weights import CAUCHY_SCALE, cauchy_loss, cauchy_weight

FAR = 25.0
"""Normalised square from which on a residual is that of a false match."""


class Sums(NamedTuple):
    """What frames add to the cost; fields as in `debrisest.filters.landmarks.cost.Cost`."""

    value: Any
    information: Any
    gradient: Any
    sightings: Any
    agreeing: Any
    dof: Any
    squares: Any
    squares_dof: Any


def sums(
    model: LandmarkModel,
    rows: Rows,
    seen: Observations,
    placed: BoolArray,
    by_start: Array,
    robust: bool,
) -> Sums:
    """Sum over frames: their rows (run, frame, ...), and what was seen of the landmarks placed.

    ``by_start (run, frame, s, n_x)`` is the derivative of the errors that rows depend on.
    """
    if compiled.available():
        return _compiled(model, rows, seen, placed, by_start, robust)
    used = seen.seen & placed[:, None, :, None]
    residual = np.where(used, (seen.shown - rows.shown) / model.sigma, 0.0)
    squares = (residual**2).sum(-1)
    weight = used * (_cauchy(squares) if robust else np.ones_like(squares))[..., None]
    information, gradient, explained = _landmark_terms(model, rows, weight, residual, by_start)
    common, squares_of_common = _common_terms(model, rows, seen, by_start, robust)
    n_x = by_start.shape[-1]
    information[:, :n_x, :n_x] += common[0]
    gradient[:, :n_x] += common[1]
    shown, near = used.any(-1), squares < FAR
    near_common = seen.common_seen & (squares_of_common < FAR)
    return Sums(
        _loss(squares, robust) + explained + common[2],
        information,
        gradient,
        shown.sum(1),
        (shown & near).sum(1),
        used.sum((-3, -2, -1)) + seen.common_seen.sum((-2, -1)),
        (squares * near).sum((-2, -1))
        + (squares_of_common * near_common).sum((-2, -1))
        + explained,
        (used & near[..., None]).sum((-3, -2, -1)) + near_common.sum((-2, -1)),
    )


def _compiled(
    model: LandmarkModel,
    rows: Rows,
    seen: Observations,
    placed: BoolArray,
    by_start: Array,
    robust: bool,
) -> Sums:
    """The same by compiled loops."""
    from debrisest.filters.landmarks.frame_sums_loops import sums

    row_parts: Any = tuple(np.ascontiguousarray(part) for part in rows)
    seen_parts: Any = tuple(np.ascontiguousarray(part) for part in seen)
    costs, information, gradient, counts, landmarks = sums(
        row_parts,
        seen_parts,
        placed,
        (model.sigma, model.common_sigma),
        np.ascontiguousarray(by_start),
        (CAUCHY_SCALE * robust, FAR),
    )
    return Sums(
        *(costs[:, 0], information, gradient, landmarks[:, 0], landmarks[:, 1]),
        *(counts[:, 0], costs[:, 1], counts[:, 1]),
    )


def _cauchy(squares: Array) -> Array:
    return cauchy_weight(squares / CAUCHY_SCALE**2)


def _loss(squares: Array, robust: bool) -> Array:
    """Sum over the epochs of squares (run, epoch, .), which Cauchy's loss lets grow slowly."""
    loss = cauchy_loss(squares / CAUCHY_SCALE**2) if robust else squares
    return np.asarray(loss.sum((-2, -1)))


def _landmark_terms(
    model: LandmarkModel, rows: Rows, weight: Array, residual: Array, by_start: Array
) -> tuple[Array, Array, Array]:
    """Information and gradient of the landmarks' rows, and what shared noise explains of them.

    A frame's rows are first summed in the few errors of its own core that they depend on.
    """
    runs, frames, points, each = residual.shape
    n_x = by_start.shape[-1]
    scale = (weight / model.sigma)[..., None]
    by_core, by_point = rows.by_core * scale, rows.by_point * scale
    flat = by_core.reshape(runs, frames, points * each, by_core.shape[-1])
    weighted = weight * residual
    line = weighted.reshape(runs, frames, points * each, 1)
    start = by_start.reshape(runs, -1, n_x)
    held = (_product(flat, flat) @ by_start).reshape(start.shape)
    crossed = np.moveaxis(_product(by_point, by_core), 1, 3).reshape(runs, 3 * points, -1)
    apart = np.moveaxis(np.concatenate([by_point, weighted[..., None]], axis=-1), 2, 1)
    squares = _product(*2 * [apart.reshape(runs, points, frames * each, 4)])[..., :3, :]
    n = n_x + 3 * points
    information, gradient = np.zeros((runs, n, n)), np.zeros((runs, n))
    information[:, :n_x, :n_x] = _product(start, held)
    information[:, n_x:, :n_x] = crossed @ start
    information[:, :n_x, n_x:] = np.swapaxes(information[:, n_x:, :n_x], -1, -2)
    gradient[:, :n_x] = _product(start, _product(flat, line).reshape(runs, -1, 1))[..., 0]
    among = n_x + np.arange(3 * points).reshape(points, 3)
    information[:, among[:, :, None], among[:, None, :]] = squares[..., :3]
    gradient[:, among] = squares[..., 3]
    if rows.shared.shape[-1] == 0:
        return information, gradient, np.zeros(runs)
    shared = rows.shared * scale
    causes = shared.reshape(*flat.shape[:-1], shared.shape[-1])
    by_points = np.moveaxis(_product(shared, by_point), -2, -3)
    right = [
        _product(causes, flat) @ by_start,
        by_points.reshape(*by_points.shape[:-2], 3 * points),
        _product(causes, line),
    ]
    return _without_shared(information, gradient, causes, np.concatenate(right, axis=-1))


def _without_shared(
    information: Array, gradient: Array, causes: Array, right: Array
) -> tuple[Array, Array, Array]:
    """Take out what the frames' shared noise, unknowns of unit variance, makes uncertain.

    ``right (run, frame, cause, n + 1)`` are the products of the causes with rows and residuals.
    """
    total = np.eye(causes.shape[-1]) + _product(causes, causes)
    half = np.linalg.solve(np.linalg.cholesky(total), right)
    half = half.reshape(len(half), -1, half.shape[-1])
    known, seen = half[..., :-1], half[..., -1:]
    return (
        information - _product(known, known),
        gradient - _product(known, seen)[..., 0],
        -(seen**2).sum((-2, -1)),
    )


def _common_terms(
    model: LandmarkModel, rows: Rows, seen: Observations, by_start: Array, robust: bool
) -> tuple[tuple[Array, Array, Array], Array]:
    """Information, gradient and loss of the common rows, each weighed by itself; squares."""
    difference = (seen.common - rows.common) / model.common_sigma
    squares = np.where(seen.common_seen, difference, 0.0) ** 2
    weight = seen.common_seen * (_cauchy(squares) if robust else 1.0)
    residual = np.where(seen.common_seen, weight * difference, 0.0)
    flat = (rows.common_by_core * (weight / model.common_sigma)[..., None]) @ by_start
    count = residual.shape[1] * residual.shape[2]
    flat = flat.reshape(len(flat), count, by_start.shape[-1])
    gradient = _product(flat, residual.reshape(len(flat), count, 1))[..., 0]
    return (_product(flat, flat), gradient, _loss(squares, robust)), squares


def _product(a: Array, b: Array) -> Array:
    return np.asarray(np.swapaxes(a, -1, -2) @ b)
