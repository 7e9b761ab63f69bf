"""Cost of a landmark model over the frames of a window, as a quadratic form at the start.

The unknowns are the start's parameters and the points. The cost is twice the negative logarithm of
the posterior density, or with Cauchy's loss one that lets go of false matches gradually.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.landmark_model import LandmarkModel, Observations, Rows, in_line
from debrisest.filters.weights import CAUCHY_SCALE, cauchy_loss, cauchy_weight

FAR = 25.0
"""Normalised square from which on a residual is that of a false match."""
_BLOCK = 128  # frames whose rows are held at a time


class Unknowns(NamedTuple):
    """Parameters (run, n_x) of the start, points (run, N, 3), and which of these exist."""

    parameters: Array
    points: Array
    placed: BoolArray
    """(run, N)."""

    @property
    def vector(self) -> Array:
        """All of them, (run, n_x + 3 N)."""
        return np.concatenate([self.parameters, in_line(self.points)], -1)

    def moved(self, step: Array) -> "Unknowns":
        """Return the unknowns after a step (run, n_x + 3 N)."""
        n_x = self.parameters.shape[-1]
        shift = step[:, n_x:].reshape(self.points.shape)
        return self._replace(parameters=self.parameters + step[:, :n_x], points=self.points + shift)


class Prior(NamedTuple):
    """Gaussian prior of the unknowns: mean (run, n_x + 3 N) and information (run, ., .)."""

    mean: Array
    information: Array


class _Part(NamedTuple):
    """What frames add to the cost; fields as in `Cost`."""

    value: Any
    information: Any
    gradient: Any
    sightings: Any
    agreeing: Any
    dof: Any
    squares: Any
    squares_dof: Any


class Cost(NamedTuple):
    """Cost (run,) around the unknowns, its information (run, n, n) and gradient (run, n)."""

    value: Array
    information: Array
    gradient: Array
    sightings: IntArray
    """Frames that show a landmark, (run, N)."""
    agreeing: IntArray
    """Those that do not look like false matches."""
    dof: IntArray
    """Components that count, (run,)."""
    squares: Array
    """Sum of the squares of those that do not look like false matches, (run,)."""
    squares_dof: IntArray
    """Their number, (run,)."""
    last: Array
    """Core (run, n) at the last frame."""
    by_start: Array
    """Derivative (run, n_c, n_x) of its errors by the parameters of the start."""

    @property
    def ratio(self) -> Array:
        """Square per component (run,), about one for the right minimum."""
        return np.asarray(self.squares / np.maximum(self.squares_dof, 1))

    @property
    def limit(self) -> Array:
        """Ratio (run,) that noise exceeds by chance once in a million times."""
        return np.asarray(1.0 + 5.0 * np.sqrt(2.0 / np.maximum(self.squares_dof, 1)))

    @property
    def far(self) -> Array:
        """Share of the sightings (run,) that look like false matches."""
        return np.asarray(1.0 - self.agreeing.sum(-1) / np.maximum(self.sightings.sum(-1), 1))


def cost(
    model: LandmarkModel,
    observed: Observations,
    prior: Prior,
    at: Unknowns,
    frames: IntArray,
    robust: bool,
) -> Cost:
    """Linearise the cost of the ``frames``, ascending epochs, at unknowns of all the runs."""
    core, by_parameters = model.start(at.parameters)
    cores, transitions = model.trajectory(core, int(frames[-1]))
    offset = prior.mean - at.vector
    gradient = (prior.information @ offset[..., None])[..., 0]
    prior_value = (offset * gradient).sum(-1)
    total = _Part(prior_value, prior.information, gradient, 0, 0, 0, 0.0, 0)
    for first in range(0, len(frames), _BLOCK):
        part = frames[first : first + _BLOCK]
        by_start = transitions[:, part][..., model.shown_by, :] @ by_parameters[:, None]
        seen = observed.at(slice(None), part)
        rows = model.rows(cores[:, part], at.points[:, None], part)
        found = _of_frames(model, rows, seen, at, by_start, robust)
        total = _Part(*(old + new for old, new in zip(total, found)))
    return Cost(*total, cores[:, -1], transitions[:, -1] @ by_parameters)


def residuals(
    model: LandmarkModel, observed: Observations, at: Unknowns, last: int
) -> Iterator[tuple[IntArray, Array, Array, Array]]:
    """Yield epochs up to ``last`` with their normalised residuals, NaN where nothing was seen.

    Of the landmarks (run, epoch, N, r), of what is common (run, epoch, m); and the noise
    (run, epoch, N, r, c), normalised, that the landmarks of an epoch share.
    """
    cores, _ = model.trajectory(model.start(at.parameters)[0], last)
    for first in range(0, last + 1, _BLOCK):
        part = np.arange(first, min(first + _BLOCK, last + 1))
        rows = model.rows(cores[:, part], at.points[:, None], part)
        seen = observed.at(slice(None), part)
        used = seen.seen & at.placed[:, None, :, None]
        yield (
            part,
            np.where(used, (seen.shown - rows.shown) / model.sigma, np.nan),
            np.where(seen.common_seen, (seen.common - rows.common) / model.common_sigma, np.nan),
            rows.shared / model.sigma[:, None],
        )


def without_far(
    model: LandmarkModel, observed: Observations, at: Unknowns, last: int
) -> Observations:
    """Observations less what lies `FAR` from the solution ``at``, up to the epoch ``last``."""
    seen, common_seen = observed.seen.copy(), observed.common_seen.copy()
    for part, residual, common, _ in residuals(model, observed, at, last):
        seen[:, part] &= (np.nansum(residual**2, axis=-1) < FAR)[..., None]
        common_seen[:, part] &= ~(common**2 >= FAR)
    return observed._replace(seen=seen, common_seen=common_seen)


def _of_frames(
    model: LandmarkModel,
    rows: Rows,
    seen: Observations,
    at: Unknowns,
    by_start: Array,
    robust: bool,
) -> _Part:
    """What some frames add to the cost."""
    used = seen.seen & at.placed[:, None, :, None]
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
    return _Part(
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
    by_core, by_point = rows.by_core[..., model.shown_by] * scale, rows.by_point * scale
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
    by_core = rows.common_by_core[..., model.shown_by]
    flat = (by_core * (weight / model.common_sigma)[..., None]) @ by_start
    count = residual.shape[1] * residual.shape[2]
    flat = flat.reshape(len(flat), count, by_start.shape[-1])
    gradient = _product(flat, residual.reshape(len(flat), count, 1))[..., 0]
    return (_product(flat, flat), gradient, _loss(squares, robust)), squares


def _product(a: Array, b: Array) -> Array:
    return np.asarray(np.swapaxes(a, -1, -2) @ b)
