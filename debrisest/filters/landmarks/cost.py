"""Cost of a landmark model over the frames of a window, as a quadratic form at the start.

The unknowns are the start's parameters and the points. The cost is twice the negative logarithm of
the posterior density, or with Cauchy's loss one that lets go of false matches gradually.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.landmark_model import LandmarkModel, Observations, Rows
from debrisest.filters.weights import CAUCHY_SCALE, cauchy_loss, cauchy_weight

_AGREEING = 4.0
"""Sigmas within which a landmark's residual is no false match."""


class Unknowns(NamedTuple):
    """Parameters (run, n_x) of the start, points (run, N, 3), and which of these exist."""

    parameters: Array
    points: Array
    placed: BoolArray
    """(run, N)."""

    @property
    def vector(self) -> Array:
        """All of them, (run, n_x + 3 N)."""
        return np.concatenate([self.parameters, self.points.reshape(len(self.points), -1)], -1)

    def moved(self, step: Array) -> "Unknowns":
        """Return the unknowns after a step (run, n_x + 3 N)."""
        n_x = self.parameters.shape[-1]
        shift = step[:, n_x:].reshape(self.points.shape)
        return self._replace(parameters=self.parameters + step[:, :n_x], points=self.points + shift)


class Prior(NamedTuple):
    """Gaussian prior of the unknowns: mean (run, n_x + 3 N) and information (run, ., .)."""

    mean: Array
    information: Array


class Cost(NamedTuple):
    """Cost (run,) around the unknowns, its information (run, n, n) and gradient (run, n)."""

    value: Array
    information: Array
    gradient: Array
    sightings: IntArray
    """Frames that show a landmark, (run, N)."""
    agreeing: IntArray
    """Those that do not look like false matches."""
    dof: Array
    """Components that count, (run,)."""


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
    seen = observed.at(slice(None), frames)
    rows = model.rows(cores[:, frames], at.points[:, None], frames)
    by_start = transitions[:, frames] @ by_parameters[:, None]
    used = seen.seen & at.placed[:, None, :, None]
    residual = np.where(used, (seen.shown - rows.shown) / model.sigma, 0.0)
    squares = (residual**2).sum(-1)
    weight = used * (_cauchy(squares) if robust else np.ones_like(squares))[..., None]
    offset = prior.mean - at.vector
    gradient = (prior.information @ offset[..., None])[..., 0]
    value = (offset * gradient).sum(-1) + _loss(squares, robust)
    terms = _landmark_terms(model, rows, weight, residual, by_start)
    common = _common_terms(model, rows, seen, by_start, robust)
    information = prior.information + terms[0]
    gradient += terms[1]
    n_x = at.parameters.shape[-1]
    information[:, :n_x, :n_x] += common[0]
    gradient[:, :n_x] += common[1]
    shown = used.any(-1)
    return Cost(
        value + terms[2] + common[2],
        information,
        gradient,
        shown.sum(1),
        (shown & (squares < _AGREEING**2)).sum(1),
        used.sum((-3, -2, -1)) + seen.common_seen.sum((-2, -1)),
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
    """Information and gradient of the landmarks' rows, and what shared noise explains of them."""
    runs, frames, points, each = residual.shape
    n_x = by_start.shape[-1]
    scale = (weight / model.sigma)[..., None]
    flat = (rows.by_core * scale).reshape(runs, frames, points * each, -1)
    to_start = (flat @ by_start).reshape(runs, frames, points, each, n_x)
    by_point, weighted = rows.by_point * scale, weight * residual
    n = n_x + 3 * points
    information, gradient = np.zeros((runs, n, n)), np.zeros((runs, n))
    rest = to_start.reshape(runs, -1, n_x)
    information[:, :n_x, :n_x] = _product(rest, rest)
    gradient[:, :n_x] = _product(rest, weighted.reshape(runs, -1, 1))[..., 0]
    both = np.concatenate([to_start, by_point, weighted[..., None]], axis=-1)
    both = np.ascontiguousarray(np.moveaxis(both, 2, 1)).reshape(runs, points, -1, n_x + 4)
    products = _product(both[..., n_x : n_x + 3], both)
    for i in range(points):
        block = slice(n_x + 3 * i, n_x + 3 * i + 3)
        information[:, block, :n_x] = products[:, i, :, :n_x]
        information[:, :n_x, block] = np.swapaxes(products[:, i, :, :n_x], -1, -2)
        information[:, block, block] = products[:, i, :, n_x : n_x + 3]
        gradient[:, block] = products[:, i, :, -1]
    if rows.shared.shape[-1] == 0:
        return information, gradient, np.zeros(runs)
    shared = rows.shared * scale
    return _without_shared(information, gradient, to_start, by_point, weighted, shared)


def _without_shared(
    information: Array,
    gradient: Array,
    to_start: Array,
    by_point: Array,
    weighted: Array,
    shared: Array,
) -> tuple[Array, Array, Array]:
    """Take out what the frames' shared noise, unknowns of unit variance, makes uncertain."""
    runs, frames, points, each, causes = shared.shape
    flat = shared.reshape(runs, frames, points * each, causes)
    total = np.eye(causes) + _product(flat, flat)
    right = [
        _product(flat, to_start.reshape(runs, frames, points * each, -1)),
        np.moveaxis(_product(shared, by_point), -2, -3).reshape(runs, frames, causes, -1),
        _product(flat, weighted.reshape(runs, frames, -1, 1)),
    ]
    half = np.linalg.solve(np.linalg.cholesky(total), np.concatenate(right, axis=-1))
    half = half.reshape(runs, frames * causes, -1)
    known, seen = half[..., :-1], half[..., -1:]
    return (
        information - _product(known, known),
        gradient - _product(known, seen)[..., 0],
        -(seen**2).sum((-2, -1)),
    )


def _common_terms(
    model: LandmarkModel, rows: Rows, seen: Observations, by_start: Array, robust: bool
) -> tuple[Array, Array, Array]:
    """Information, gradient and loss of the common rows, each weighed by itself."""
    difference = (seen.common - rows.common) / model.common_sigma
    squares = np.where(seen.common_seen, difference, 0.0) ** 2
    weight = seen.common_seen * (_cauchy(squares) if robust else 1.0)
    residual = np.where(seen.common_seen, weight * difference, 0.0)
    flat = (rows.common_by_core * (weight / model.common_sigma)[..., None]) @ by_start
    flat = flat.reshape(len(flat), -1, by_start.shape[-1])
    gradient = _product(flat, residual.reshape(len(flat), -1, 1))[..., 0]
    return _product(flat, flat), gradient, _loss(squares, robust)


def _product(a: Array, b: Array) -> Array:
    return np.asarray(np.swapaxes(a, -1, -2) @ b)
