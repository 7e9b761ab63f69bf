"""The spread of a replay whose cost bends.

Of an error that the measurements hardly tell, the valley of the cost may bend, and end far from
where the curvature at the estimate says: of a body that spins about one axis, they tell the product
of its tilt and of a slope of its inertia, and either may be what is zero. So the floor of the cost,
the least with that error held, is sought three sigma to both sides, and followed on where it is
lower than nine. With u and d the errors of one sigma to either side, the covariance is that of
both, ``(u u^T + d d^T) / 2``: of half their way, and of how far its middle is off, as in
`batch/spread.py`.
"""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters import weights
from debrisest.filters.estimates import Estimates, finite
from debrisest.filters.replay.floor import errors_per_sigma
from debrisest.filters.replay.half_way import half_way, joint_square, moved
from debrisest.filters.replay.measured_arc import MeasuredArc, linearize, measured_arc, residuals
from debrisest.filters.replay_model import ReplayModel

_TOGETHER = 12_000  # epochs of all runs at a time, for the sake of memory


def with_bends(
    model: ReplayModel,
    prior: Array,
    covariance: Array,
    measured: Array,
    found: Estimates,
    gate: bool = False,
    smoothed: bool = False,
    truth: Array | None = None,
) -> Estimates:
    """Return the estimates, their covariances at the kept epochs widened by what bends.

    By what `replay` was given and what it gave, or `smooth` if they are ``smoothed``, each from all
    that it was made of. With `gate`, what its residual rejects is left out. The sigmas of other
    epochs are widened by as much as at the next one that is kept.

    With the ``truth (run, time, n)`` `square_half_way` is counted at the kept epochs: the joint
    error in sigmas, squared, half way between the first measurement and there.
    """
    if not model.bending and truth is None:
        return found
    sigma, spread = found.sigma.copy(), found.covariance.copy()
    square = np.full(sigma.shape[:2], np.nan)
    last, slots = measured.shape[1] - 1, np.arange(len(found.kept))
    for together in [slots] if smoothed else slots[:, None]:
        kept = found.kept[together]
        end = last if smoothed else int(kept[0])
        middle = half_way(measured, end)
        for some in _parts(found.state[:, end], spread[:, together[-1]], end):
            part = model.of(some)
            arc = measured_arc(part, prior[some], covariance[some], measured[some, : end + 1])
            state, own = found.state[some, end], spread[some, together[-1]]
            with np.errstate(all="ignore"):
                start = part.rewind(state, end)
                ways = _ways(part, arc, start, [middle, *kept.tolist()], gate)
                if truth is not None:
                    at, wide = moved(part, state, own, end, middle)
                    wide += _added(part, wide, *ways[0])
                    off = joint_square(part, at, wide, truth[some, middle])
                    square[np.ix_(some, kept)] = off[:, None]
                for slot, way in zip(together, ways[1:]):
                    more = _added(part, spread[some, slot], *way)
                    _widen(sigma, spread, some, found.kept, slot, more)
    counts = found.counts | ({} if truth is None else {"square_half_way": square})
    return found._replace(sigma=sigma, covariance=spread, counts=counts)


def _parts(state: Array, spread: Array, end: int) -> list[IntArray]:
    """Runs that are not lost by epoch ``end``, as many at a time as memory allows; maybe none."""
    runs = np.flatnonzero(finite(state, spread))
    size = max(1, _TOGETHER // (end + 1))
    return [part for part in np.split(runs, range(size, len(runs), size)) if len(part)]


def _widen(
    sigma: Array, spread: Array, runs: IntArray, kept: IntArray, slot: int, more: Array
) -> None:
    """Add to the covariance of an epoch that is kept, and to the sigmas since the one before."""
    spread[runs, slot] += more
    since = slice(kept[slot - 1] + 1 if slot else 0, kept[slot] + 1)
    variance = np.diagonal(more, 0, -2, -1)[:, None]
    sigma[runs, since] = np.sqrt(sigma[runs, since] ** 2 + variance)


def _ways(
    model: ReplayModel, arc: MeasuredArc, start: Array, epochs: list[int], gate: bool
) -> Array:
    """Errors on the floor, as of `errors_per_sigma`."""
    last = arc.measured.shape[1] - 1
    if gate:
        residual = residuals(model, arc, model.shown(start, last)[1])
        arc = arc._replace(weight=arc.seen * weights.hard(residual))
    return errors_per_sigma(model, arc, linearize(model, arc, start, last), epochs)


def _added(model: ReplayModel, spread: Array, ahead: Array, behind: Array) -> Array:
    """What bends adds to a covariance (run, n_e, n_e)."""
    added = np.zeros_like(spread)
    for error in model.bending:
        _add(added, spread, error, ahead[:, error], behind[:, error])
    return added


def _add(added: Array, spread: Array, error: int, ahead: Array, behind: Array) -> None:
    """Add what an error has, by its errors of one sigma (run, n_e) to both sides; NaN: unknown."""
    up, down = np.where(np.isnan(ahead), behind, ahead), np.where(np.isnan(behind), ahead, behind)
    half, middle = np.nan_to_num(0.5 * (up + down)), np.nan_to_num(0.5 * (up - down))
    stated = spread[:, error, error] + added[:, error, error]
    wider = np.maximum(1.0 - stated / np.maximum(half[:, error] ** 2, np.finfo(float).tiny), 0.0)
    for share, way in ((wider, half), (np.ones(len(half)), middle)):
        added += share[:, None, None] * way[:, :, None] * way[:, None, :]
