"""Whether the motion of a replay fits all measurements, and what speaks for more than its model."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.filters import weights
from debrisest.filters.estimates import Estimates, finite
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.replay.measured_arc import MeasuredArc, measured_arc
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.runs import put
from debrisest.filters.self_test import block_test, cost_test, rival_test, score_test
from debrisest.filters.verdict import SelfTest

_BLOCKS = 10
_TOGETHER = 10  # runs at a time, for the sake of memory
_SHOWN = 1e-9
"""Part of a doubt's information that must not be that of the errors."""


class _Fit(NamedTuple):
    """What is left of the measurements at the estimate, run first."""

    cost: Array
    rows: Array
    """Number of measurements that count."""
    blocks: Array
    """Normalised sums of residuals over blocks of time, (run, block, m)."""
    doubt: Array
    """What each doubted number would be if it were free, (run, doubt), and its sigma."""
    sigma: Array


def self_tests(
    model: ReplayModel,
    prior: Array,
    covariance: Array,
    measured: Array,
    found: Estimates,
    gate: bool = False,
) -> list[SelfTest]:
    """Return the tests of all runs, by what `replay` was given and what it gave.

    With `gate`, what its residual rejects is left out. Runs without an end are not tested.
    """
    last, m = measured.shape[1] - 1, measured.shape[2]
    end, doubts = found.state[:, last], model.doubts
    runs = np.flatnonzero(finite(end, found.covariance[:, -1]))
    shapes = (), (), (_BLOCKS, m), (len(doubts),), (len(doubts),)
    fit = _Fit(*(np.full((len(prior), *shape), np.nan) for shape in shapes))
    with np.errstate(all="ignore"):
        for begin in range(0, len(runs), _TOGETHER):
            some = runs[begin : begin + _TOGETHER]
            part = model.of(some)
            arc = measured_arc(part, prior[some], covariance[some], measured[some])
            put(fit, some, _fit(part, arc, part.rewind(end[some], last), gate))
    tests = [
        cost_test(fit.cost, np.nan_to_num(fit.rows)),
        block_test(fit.blocks, len(model.error_names)),
    ]
    for i, doubt in enumerate(doubts):
        tests.append(score_test(fit.doubt[:, i], fit.sigma[:, i], doubt.reason, doubt.scale))
    return [*tests, rival_test(found.counts["rival_excess"][:, last])]


def _fit(model: ReplayModel, arc: MeasuredArc, start: Array, gate: bool) -> _Fit:
    runs, epochs, m = arc.measured.shape
    states, sensitivity = model.trajectory(start, 0, epochs - 1)
    predicted, derivative = model.rows(states, sensitivity, 0, np.arange(epochs))
    residual = np.where(arc.seen, arc.measured - predicted / model.sigma, 0.0)
    used = arc.seen & ((weights.hard(residual) > 0.0) | (not gate))
    offset = model.plain_difference(arc.prior, start)
    pull = (arc.information @ offset[..., None])[..., 0]
    weight = (used / model.sigma)[..., None]
    left = np.where(used, residual, 0.0).reshape(runs, -1, 1)
    columns = [doubt.column(states, sensitivity, predicted, derivative) for doubt in model.doubts]
    rows = (weight * derivative).reshape(runs, epochs * m, -1)
    doubted = (weight * np.stack([*columns], -1)).reshape(runs, epochs * m, -1) if columns else None
    return _Fit(
        (offset * pull).sum(-1) + (left**2).sum((1, 2)),
        used.sum((1, 2)).astype(np.float64),
        _block_sums(residual, used),
        *_scores(rows, left, arc.information, pull, doubted),
    )


def _scores(
    rows: Array, left: Array, prior: Array, pull: Array, doubted: Array | None
) -> tuple[Array, Array]:
    """Doubted numbers and their sigmas (run, doubt), each alone beside all errors (Rao's test).

    What the errors cannot make of a number is its column less its projection, found twice: the
    difference of two sums would be rounding where that is little.
    """
    if doubted is None:
        return np.empty((len(rows), 0)), np.empty((len(rows), 0))
    transposed = np.swapaxes(rows, -1, -2)
    spread = scaled_inverse(prior + transposed @ rows)
    shared = spread @ (transposed @ doubted)
    apart = doubted - rows @ shared
    again = spread @ (transposed @ apart - prior @ shared)
    shared, apart = shared + again, apart - rows @ again
    score = (apart * left).sum(1) - (shared * pull[..., None]).sum(1)
    alone, own = (doubted**2).sum(1), (apart**2).sum(1) + (shared * (prior @ shared)).sum(1)
    own = np.where(own > _SHOWN * alone, own, np.nan)
    return score / own, own**-0.5


def _block_sums(residual: Array, used: BoolArray) -> Array:
    """Sums (run, block, m) of residuals (run, epoch, m) that are unit normal; NaN without any."""
    edges = np.linspace(0, residual.shape[1], _BLOCKS + 1).astype(np.int64)[:-1]
    total = np.add.reduceat(np.where(used, residual, 0.0), edges, axis=1)
    count = np.add.reduceat(used.astype(np.float64), edges, axis=1)
    return np.asarray(total / np.sqrt(np.where(count > 0.0, count, np.nan)))
