"""The update of `update` by compiled loops, whose steps need no gain."""

from typing import Any

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.filters.gate import chi_square_limits
from debrisest.filters.landmark_model import LandmarkModel, Observations
from debrisest.filters.landmarks.update import Belief, Frame, UpdateSettings, moved_by
from debrisest.filters.landmarks.update_loops import contracted, step

_AT_ONCE = 8
"""Rows by which the covariance shrinks at once: there is room for as many times this."""
_JUDGED = np.empty(0)
"""No limits, for steps after that in which the gate has judged."""


def compiled_update(
    model: LandmarkModel,
    prior: Belief,
    observed: Observations,
    k: int,
    settings: UpdateSettings,
    inflation: float,
) -> tuple[Belief, Frame]:
    """Update with frame k, as `debrisest.filters.landmarks.update.update` has it."""
    seen = observed.seen.reshape(len(observed.seen), -1)
    used: BoolArray = np.concatenate([seen, observed.common_seen], axis=-1)
    (runs, m), n_e = used.shape, prior.covariance.shape[-1]
    before, correction = used.sum(-1), np.zeros((runs, n_e))
    whitened = np.zeros((runs, -(-m // _AT_ONCE) * _AT_ONCE, n_e))
    shown, common = np.ascontiguousarray(observed.shown), np.ascontiguousarray(observed.common)
    sigma = np.concatenate([np.tile(model.sigma, model.landmarks), model.common_sigma])
    going, limits, count = np.arange(runs), _limits(model, settings), np.zeros(runs, np.int64)
    at, nis = (prior.core, prior.points), np.zeros(runs)
    for i in range(settings.iterations):
        rows: Any = model.rows(at[0][:, None], at[1][:, None], np.array([k]))
        rows = tuple(np.ascontiguousarray(part) for part in rows)
        moved, squares = step(
            going,
            rows,
            shown,
            common,
            prior.covariance,
            model.shown_by,
            sigma,
            inflation,
            settings.tolerance,
            limits,
            used,
            whitened,
            correction,
        )
        count[going] += 1
        nis, limits = (nis if i else squares), _JUDGED
        at, going = moved_by(model, prior, correction), np.flatnonzero(moved)
        if len(going) == 0:
            break
    accepted: BoolArray = np.asarray(used[:, : seen.shape[1]].reshape(observed.seen.shape).any(-1))
    dof = used.sum(-1)
    belief = Belief(*at, contracted(prior.covariance, whitened))
    return belief, Frame(nis, dof, before - dof, accepted, count)


def _limits(model: LandmarkModel, settings: UpdateSettings) -> Array:
    """Limits of the gate by the number of a landmark's components, or none."""
    if settings.false_alarm is None:
        return _JUDGED
    return chi_square_limits(settings.false_alarm, model.rows_each)
