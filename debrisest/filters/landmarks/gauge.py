"""Directions that nothing measures, along which a filter that linearises anew believes to learn.

Each linearisation has the gauge in another direction, so that all of them together seem to tell it
(Huang et al. 2010 on simultaneous localisation and mapping). The information along it cannot grow:
the least addition to the covariance that takes out what was gained is one along the gauge itself.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.filters.landmark_model import LandmarkModel
from debrisest.filters.landmarks.update import Belief
from debrisest.filters.linear_algebra import scaled_inverse, solve


def information(model: LandmarkModel, belief: Belief) -> Array | None:
    """What a belief without landmarks knows along the gauge ``(run, g, g)``.

    None if the model has no gauge, or the belief holds it exactly.
    """
    exact = np.diagonal(belief.covariance, 0, -2, -1)[:, : model.errors] == 0.0
    if model.gauge is None or exact.any():
        return None
    return _along(model.gauge(belief.core, belief.points), belief, _no_landmark(model, belief))


def honest(
    model: LandmarkModel, belief: Belief, present: BoolArray, known: Array
) -> tuple[Array, Array]:
    """Covariance that knows no more along the gauge than ``known (run, g, g)``.

    And how many times as much was claimed (run,), in the direction where that is most.
    """
    assert model.gauge is not None
    gauge = model.gauge(belief.core, belief.points)
    claimed = _along(gauge, belief, present)
    free = scaled_inverse(known)
    missing = free - scaled_inverse(claimed)
    values, vectors = np.linalg.eigh(np.nan_to_num(missing))
    wide = gauge @ (vectors * np.sqrt(np.maximum(values, 0.0))[:, None])
    wide[:, model.errors :] *= np.repeat(present, 3, axis=-1)[..., None]
    mended = np.asarray(belief.covariance + wide @ np.swapaxes(wide, -1, -2))
    return mended, _largest_ratio(claimed, free)


def _largest_ratio(claimed: Array, free: Array) -> Array:
    root = np.linalg.cholesky(free)
    whitened = np.swapaxes(root, -1, -2) @ np.nan_to_num(claimed) @ root
    return np.asarray(np.linalg.eigvalsh(whitened)[:, -1])


def _along(gauge: Array, belief: Belief, present: BoolArray) -> Array:
    """Information of a belief along the gauge, of the core and of the landmarks that are there."""
    core = gauge.shape[1] - 3 * present.shape[1]
    there = np.concatenate(
        [np.ones((len(gauge), core), dtype=np.bool_), np.repeat(present, 3, axis=-1)], axis=-1
    )
    variance = np.diagonal(belief.covariance, 0, -2, -1)
    scale = np.where(there, variance, 1.0) ** -0.5
    both = there[:, :, None] & there[:, None, :]
    scaled = scale[:, :, None] * belief.covariance * scale[:, None]
    along = np.where(there, scale, 0.0)[..., None] * gauge
    told = np.where(both, scaled, np.eye(there.shape[-1]))
    found = np.swapaxes(along, -1, -2) @ solve(told, along)
    return np.asarray(0.5 * (found + np.swapaxes(found, -1, -2)))


def _no_landmark(model: LandmarkModel, belief: Belief) -> BoolArray:
    return np.zeros((len(belief.core), model.landmarks), dtype=np.bool_)
