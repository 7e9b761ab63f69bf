"""Levenberg-Marquardt on the start of a landmark model over windows that grow.

From a first guess that is far off, a long window has many minima and a short one few; each window
begins where the one before ended. Landmarks join when they are seen for the first time.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.descent import Damping, descend
from debrisest.filters.landmark_model import LandmarkModel, Observations
from debrisest.filters.landmarks.cost import Cost, Prior, Unknowns, cost
from debrisest.filters.linear_algebra import scaled_solve
from debrisest.filters.runs import take

FROM_NEAR = 1e-6
"""First damping of a window that begins at the solution of the one before it."""
_FIRST_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-3, 1e-9, 1e9
_FEW = 5
PATIENCE = 3
"""How many times as many linearisations a window may take whose end is to be right."""
_DECREASE = 0.05
"""Predicted decrease of the cost below which a window is done."""


class Window(NamedTuple):
    """Epochs from 0 to ``last``, of which every ``stride``-th counts."""

    last: int
    stride: int

    @property
    def frames(self) -> IntArray:
        """Return the epochs that count; the last one always does."""
        return np.arange(self.last, -1, -self.stride)[::-1]


class Fit(NamedTuple):
    """Where the descent ended in the last window, and the prior that it had."""

    at: Unknowns
    prior: Prior
    found: Cost


def fresh(model: LandmarkModel, parameters: Array, prior: Prior) -> tuple[Unknowns, Prior]:
    """Unknowns at the given parameters, without any landmark yet; the prior is a copy."""
    runs = len(parameters)
    points = np.zeros((runs, model.landmarks, 3))
    at = Unknowns(parameters.copy(), points, np.zeros(points.shape[:2], dtype=np.bool_))
    return at, Prior(*(values.copy() for values in prior))


def fit(
    model: LandmarkModel,
    observed: Observations,
    at: Unknowns,
    prior: Prior,
    windows: Sequence[Window],
    iterations: int,
    robust: bool,
) -> Fit:
    """Minimise the cost over the windows in turn, at most ``iterations`` linearisations each.

    The last one, from which no other will go on, may take `PATIENCE` times as many.
    """
    for window in windows:
        at, prior = place(model, observed, at, prior, window.last)
        most = iterations if window is not windows[-1] else PATIENCE * iterations
        found = descend_on(model, observed, at, prior, window.frames, most, robust)
    return found


def place(
    model: LandmarkModel, observed: Observations, at: Unknowns, prior: Prior, last: int
) -> tuple[Unknowns, Prior]:
    """Give a place to the landmarks that were seen for the first time up to epoch ``last``."""
    seen = model.placeable(observed.seen[:, : last + 1])
    new = seen.any(1) & ~at.placed
    if not new.any():
        return at, prior
    first = _typical_sighting(observed.shown[..., : model.directions], seen)
    cores = model.path(model.start(at.parameters)[0], last)
    runs, landmarks = np.arange(len(first))[:, None], np.arange(first.shape[1])
    points, _, _ = model.place(cores[runs, first], observed.shown[runs, first, landmarks], first)
    found = Unknowns(at.parameters, np.where(new[..., None], points, at.points), at.placed | new)
    n_x = at.parameters.shape[-1]
    mean = prior.mean.copy()
    mean[:, n_x:] = np.where(np.repeat(new, 3, axis=-1), found.vector[:, n_x:], mean[:, n_x:])
    return found, prior._replace(mean=mean)


def _typical_sighting(directions: Array, seen: BoolArray) -> IntArray:
    """Epoch (run, N), of the first few sightings, of the one nearest to their median.

    So that a false match among them is not taken for the landmark.
    """
    order = np.where(seen, np.cumsum(seen, axis=1), seen.shape[1] + 1)
    epochs = np.argsort(order, axis=1, kind="stable")[:, :_FEW]
    known = np.take_along_axis(seen, epochs, axis=1)[..., None]
    shown = np.take_along_axis(directions, epochs[..., None], axis=1)
    middle = np.nanmedian(np.where(known | ~known.any(1, keepdims=True), shown, np.nan), axis=1)
    distance = np.where(known, (shown - middle[:, None]) ** 2, np.inf).sum(-1)
    nearest = np.argmin(distance, axis=1)
    return np.take_along_axis(epochs, nearest[:, None], axis=1)[:, 0]


def descend_on(
    model: LandmarkModel,
    observed: Observations,
    at: Unknowns,
    prior: Prior,
    frames: IntArray,
    iterations: int,
    robust: bool,
    damping: float = _FIRST_DAMPING,
) -> Fit:
    """Lower the cost of every run, the first step damped so much; ``at`` is changed in place."""

    def trial(best: Fit, runs: IntArray, step: Array) -> Fit:
        moved, part = take(best.at, runs).moved(step), take(prior, runs)
        found = cost(model.of(runs), observed.at(runs), part, moved, frames, robust)
        return Fit(moved, part, _usable(found))

    first = Fit(at, prior, _usable(cost(model, observed, prior, at, frames, robust)))
    rule = Damping(damping, _next_damping, _done)
    return descend(first, lambda fit: fit.found.value, _step, trial, rule, iterations)[0]


def _usable(found: Cost) -> Cost:
    """Cost that is infinite where it, or what a step needs, is not finite."""
    sound = np.isfinite(found.value) & np.isfinite(found.gradient).all(-1)
    found.value[~(sound & np.isfinite(found.information).all((-2, -1)))] = np.inf
    return found


def _step(fit: Fit, _: IntArray, damping: Array) -> tuple[Array, Array]:
    """Damped step and the decrease of the cost that it promises."""
    at = fit.found
    size = np.diagonal(at.information, 0, -2, -1)
    damped = at.information.copy()
    index = np.arange(size.shape[-1])
    damped[:, index, index] += damping[:, None] * size
    step = scaled_solve(damped, at.gradient)
    step = np.where(np.isfinite(step).all(-1, keepdims=True), step, 0.0)
    promise = (at.gradient * step).sum(-1) + damping * (size * step**2).sum(-1)
    return step, promise


def _next_damping(damping: Array, better: BoolArray) -> Array:
    return np.where(better, np.maximum(damping / 10.0, _LEAST_DAMPING), 10.0 * damping)


def _done(_: Array, promise: Array, damping: Array) -> BoolArray:
    return np.asarray((promise < _DECREASE) | (damping >= _MOST_DAMPING))
