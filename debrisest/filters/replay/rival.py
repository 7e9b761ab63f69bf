"""The other solution of every run, which competes with the best one until it has lost.

Of a target that is far, cameras hardly tell the depth of its points from its reverse, in which it
turns the other way: the cost has two minima, and which one is lower may show only later. From the
first anchor on the mirror of the estimate is refined beside it, each by its own weights; what loses
by far is given up, what wins becomes the estimate. Of a near target one frame tells, and no more is
done.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.replay.gauss_newton import Solution, move
from debrisest.filters.replay.measured_arc import MeasuredArc
from debrisest.filters.replay.search import Search
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.rivals import GIVEN_UP, squared_distance
from debrisest.filters.runs import put, take

_HOPELESS = 1000.0
"""Cost of a single frame at the mirror from which on no refinement can mend it."""
_ITERATIONS = 10
_APART = 1.0
"""Squared distance in sigmas below which two solutions are the same: both may stop so far off."""


class Rival(NamedTuple):
    """Where the other solution is, run first."""

    state: Array
    """At epoch 0, (run, n)."""
    weight: Array
    """Of the measurements, (run, time, m)."""
    gap: Array
    """By how much it costs more, (run,); infinite where it has lost, NaN where it is the same."""
    open: BoolArray
    """Whether no frame alone speaks against a mirror, (run,)."""


def no_rival(model: ReplayModel, arc: MeasuredArc) -> Rival:
    """Return what is known of rivals before the first replay."""
    runs = len(arc.prior)
    may_be = np.full(runs, model.mirror is not None)
    return Rival(arc.prior.copy(), arc.weight.copy(), np.full(runs, np.nan), may_be)


def compete(
    search: Search, model: ReplayModel, arc: MeasuredArc, best: Solution, rival: Rival, anew: bool
) -> None:
    """Refine the rival, and change places where it costs less, all in place.

    Where it has come to the same minimum it begins at the mirror of the best solution again, since
    two may part later; with `anew` where it has lost, too, since the best one may have moved to a
    third. In the first frame the prior competes too: a first guess may lead to neither of both. The
    weights of `arc` are those of the best solution.
    """
    if search.frames == 1:
        _begin(search.last, model, arc, best, rival, np.flatnonzero(rival.open))
        rival.state[:] = arc.prior
        _refine(search, model, arc, best, rival, np.flatnonzero(rival.open))
        rival.gap[:] = np.nan
    none = np.isnan(rival.gap) | (anew & ~(rival.gap < GIVEN_UP))
    _begin(search.last, model, arc, best, rival, np.flatnonzero(rival.open & none))
    runs = np.flatnonzero(rival.open & (none | (rival.gap < GIVEN_UP)))
    _refine(search, model, arc, best, rival, runs)


def _refine(
    search: Search,
    model: ReplayModel,
    arc: MeasuredArc,
    best: Solution,
    rival: Rival,
    runs: IntArray,
) -> None:
    """Refine the rivals of some runs, and change places where they cost less, all in place."""
    if len(runs) == 0:
        return
    part, beside = model.of(runs), take(arc, runs)
    own, first = beside._replace(weight=rival.weight[runs]), take(best, runs)
    other = search._replace(iterations=_ITERATIONS).solve(part, own, [rival.state[runs]])
    lead = search.loss(part, own, other) - search.loss(part, beside, first)
    rival.state[runs], rival.weight[runs] = move(part, other.at.state, other.step), own.weight
    same = _same(part, first, other)
    rival.gap[runs] = np.where(same, np.nan, np.where(np.isfinite(lead), np.abs(lead), np.inf))
    won = np.flatnonzero(~same & (lead < 0.0))
    rival.state[runs[won]] = move(part, first.at.state, first.step)[won]
    rival.weight[runs[won]], arc.weight[runs[won]] = beside.weight[won], own.weight[won]
    put(best, runs[won], take(other, won))


def _begin(
    k: int, model: ReplayModel, arc: MeasuredArc, best: Solution, rival: Rival, runs: IntArray
) -> None:
    """Put the rivals of some runs at the mirror, unless the frame of epoch k speaks against it."""
    if model.mirror is None or len(runs) == 0:
        return
    part, frame = model.of(runs), slice(k, k + 1)
    mirrored = model.mirror(best.at.last_state[runs])
    shown = part.rows(*part.trajectory(mirrored, k, k), k, np.array([k]))[0]
    residual = arc.weight[runs, frame] * (arc.measured[runs, frame] - shown / model.sigma)
    rival.open[runs] = (residual**2).sum((1, 2)) < _HOPELESS
    rival.state[runs] = part.rewind(mirrored, k)
    rival.weight[runs] = arc.weight[runs]


def _same(model: ReplayModel, best: Solution, other: Solution) -> BoolArray:
    offset = model.plain_difference(other.at.state, best.at.state)
    return np.asarray(squared_distance(offset, best.at.information) < _APART)
