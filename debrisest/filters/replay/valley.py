"""The spread of a replay whose cost bends.

Of an error that the measurements hardly tell, the valley of the cost may bend, and end far from
where the curvature at the estimate says: of a body that spins about one axis, they tell the product
of its tilt and of a slope of its inertia, and either may be what is zero. So the floor of the cost,
the least with that error held, is sought three sigma to both sides, and followed on where it is
lower than nine. With u and d the errors of one sigma to either side, the covariance is that of
both, ``(u u^T + d d^T) / 2``: of half their way, and of how far its middle is off, as in
`batch/spread.py`.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters import weights
from debrisest.filters.estimates import Estimates, finite
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.replay.gauss_newton import Held, gauss_newton, move
from debrisest.filters.replay.measured_arc import (
    Linearization,
    MeasuredArc,
    linearize,
    measured_arc,
)
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.runs import take

_FAR, _SURE = 3.0, 5.0
"""Sigmas at which a valley is looked for, and to which one that is open is followed."""
_OPEN = 0.6
"""Part of the prior's sigma from which on an error is as good as untold: no valley is to be
followed."""
_LOW, _STEEP = 0.7, 1.7
"""Of the rise of a parabola: where the floor is to be followed on, and where it tells nothing."""
_GROWTH, _LEVELS = 3.0, 8
_FIRM = 1e-3  # sigma with which an error is held, in its own sigmas
_ITERATIONS, _TOLERANCE = 24, 1.0
"""With six iterations some floors were taken for steep that were not found yet."""
_FARTHER = 1.2
"""Times as far as before, at which a floor that goes on is found at least: else it ends there."""
_TOGETHER = 25  # runs at a time, for the sake of memory


class _Sides(NamedTuple):
    """Both sides of every error that bends, side by side."""

    run: IntArray
    error: IntArray
    sign: Array
    sigma: Array
    """By the curvature at the estimate."""
    farthest: Array
    """Three sigma of the prior."""


def with_bends(
    model: ReplayModel,
    prior: Array,
    covariance: Array,
    measured: Array,
    found: Estimates,
    gate: bool = False,
    smoothed: bool = False,
) -> Estimates:
    """Return the estimates, their covariances at the kept epochs widened by what bends.

    By what `replay` was given and what it gave, or `smooth` if they are ``smoothed``, each from all
    that it was made of. With `gate`, what its residual rejects is left out. The sigmas of other
    epochs are widened by as much as at the next one that is kept.
    """
    if not model.bending:
        return found
    sigma, spread = found.sigma.copy(), found.covariance.copy()
    before = 0
    for slot, k in enumerate(found.kept):
        last = measured.shape[1] - 1 if smoothed else int(k)
        runs = np.flatnonzero(finite(found.state[:, k], spread[:, slot]))
        parts = np.split(runs, range(_TOGETHER, len(runs), _TOGETHER))
        for some in filter(len, parts):  # none, where all runs are lost by then
            part = model.of(some)
            arc = measured_arc(part, prior[some], covariance[some], measured[some, : last + 1])
            start = part.rewind(found.state[some, k], int(k))
            with np.errstate(all="ignore"):
                more = _added(part, arc, start, spread[some, slot], int(k), gate)
            spread[some, slot] += more
            variance = np.diagonal(more, 0, -2, -1)[:, None]
            sigma[some, before : k + 1] = np.sqrt(sigma[some, before : k + 1] ** 2 + variance)
        before = int(k) + 1
    return found._replace(sigma=sigma, covariance=spread)


def _added(
    model: ReplayModel, arc: MeasuredArc, start: Array, spread: Array, k: int, gate: bool
) -> Array:
    """What bends adds to the covariance (run, n_e, n_e) of epoch k."""
    last = arc.measured.shape[1] - 1
    at = linearize(model, arc, start, last)
    if gate:
        arc = arc._replace(weight=arc.seen * weights.hard(at.residual))
        at = linearize(model, arc, start, last)
    sides = _sides(model, arc, at)
    ways = _followed(model, arc, at, sides, k)
    added = np.zeros_like(spread)
    for begin in range(0, 2 * len(model.bending), 2):
        ahead, behind = (ways[begin + i :: 2 * len(model.bending)] for i in (0, 1))
        _add(added, spread, model.bending[begin // 2], ahead, behind)
    return added


def _add(added: Array, spread: Array, error: int, ahead: Array, behind: Array) -> None:
    """Add what an error has, by its errors of one sigma (run, n_e) to both sides; NaN: unknown."""
    up, down = np.where(np.isnan(ahead), behind, ahead), np.where(np.isnan(behind), ahead, behind)
    half, middle = np.nan_to_num(0.5 * (up + down)), np.nan_to_num(0.5 * (up - down))
    stated = spread[:, error, error] + added[:, error, error]
    wider = np.maximum(1.0 - stated / np.maximum(half[:, error] ** 2, np.finfo(float).tiny), 0.0)
    for share, way in ((wider, half), (np.ones(len(half)), middle)):
        added += share[:, None, None] * way[:, :, None] * way[:, None, :]


def _sides(model: ReplayModel, arc: MeasuredArc, at: Linearization) -> _Sides:
    of_prior, of_all = scaled_inverse(arc.information), scaled_inverse(at.information)
    runs = np.arange(len(at.state))
    run, error, sign = (
        part.ravel() for part in np.meshgrid(runs, model.bending, [1, -1], indexing="ij")
    )
    sigma, farthest = (np.sqrt(part[run, error, error]) for part in (of_all, of_prior))
    return _Sides(run, error, sign.astype(np.float64), sigma, _FAR * farthest)


def _followed(
    model: ReplayModel, arc: MeasuredArc, at: Linearization, sides: _Sides, k: int
) -> Array:
    """Errors of epoch k (side, n_e) per sigma, where the floor is as high as sigmas say.

    It is followed to five sigma, to where no body is beyond, or the prior forbids it; of all places
    that are passed the one counts that asks for the largest sigma.
    """
    spread = scaled_inverse(at.information)
    toward = sides.sign[:, None] * spread[sides.run, :, sides.error] / sides.sigma[:, None]
    state = move(model.of(sides.run), at.state[sides.run], _FAR * toward)
    distance = _FAR * sides.sigma
    behind, largest = np.zeros((2, len(sides.run)))
    ends, far = state.copy(), np.full(len(sides.run), np.nan)
    going = np.flatnonzero(sides.sigma < _OPEN / _FAR * sides.farthest)
    for level in range(_LEVELS if len(going) else 0):
        side = take(sides, going)
        found, rise, reached = _floor(model, arc, at, side, state[going], distance[going])
        sigmas = np.sqrt(np.maximum(rise, 1.0))
        open_ = rise < (_SURE**2 if level else _LOW * _FAR**2)
        better = (reached / sigmas > largest[going]) & ((level > 0) | (rise < _STEEP * _FAR**2))
        ends[going[better]], far[going[better]] = found[better], sigmas[better]
        largest[going[better]] = (reached / sigmas)[better]
        on = open_ & (reached > _FARTHER * behind[going]) & (_FARTHER * reached < side.farthest)
        behind[going] = reached
        going, side, found = going[on], take(side, np.flatnonzero(on)), found[on]
        if len(going) == 0:
            break
        distance[going] = np.minimum(_GROWTH * behind[going], side.farthest)
        by = distance[going] - behind[going]
        state[going] = _pushed(model.of(side.run), found, side, by)
    part = model.of(sides.run)
    at_k, ends_k = (part.trajectory(one, 0, k)[0][:, -1] for one in (at.state[sides.run], ends))
    error = part.inverse_chart(at_k) @ part.difference(ends_k, at_k)[..., None]
    return np.asarray(sides.sign[:, None] * error[..., 0] / far[:, None])


def _pushed(model: ReplayModel, state: Array, side: _Sides, by: Array) -> Array:
    """States (side, n) whose error is pushed on by itself: the others follow, best from there.

    Of a product of both, what is linearised with the one before it moves is wrong for the other.
    """
    step = np.zeros((len(state), len(model.error_names)))
    step[np.arange(len(state)), side.error] = side.sign * by
    return move(model, state, step)


def _floor(
    model: ReplayModel,
    arc: MeasuredArc,
    at: Linearization,
    side: _Sides,
    state: Array,
    distance: Array,
) -> tuple[Array, Array, Array]:
    """The best states (side, n) at a distance, by how much they cost more, and how far they are."""
    part, last = model.of(side.run), arc.measured.shape[1] - 1
    held = Held(side.error, at.state[side.run], side.sign * distance, _FIRM * side.sigma)
    limits = last, _ITERATIONS, _TOLERANCE
    found = gauss_newton(part, take(arc, side.run), state, *limits, held=held)
    done = found.decrement < _TOLERANCE
    best = np.where(done[:, None], move(part, found.at.state, found.step), found.at.state)
    cost = found.at.cost - np.where(done, found.decrement, 0.0)
    rise = cost - (held.miss(part, found.at.state) / held.sigma) ** 2 * ~done - at.cost[side.run]
    return best, rise, distance - np.abs(held.miss(part, best))
