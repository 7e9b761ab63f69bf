"""From a start to the whole arc: windows that go on growing, each over all its frames.

The cost of every window is linearised anew at its own solution, so that no early linearisation
lasts. Two solutions that both fit go on side by side until the data tell them apart; one that no
longer fits is begun again, from its mirror and from other first guesses.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.landmark_model import LandmarkModel, Observations
from debrisest.filters.landmarks.batch_start import (
    Problem,
    Rivals,
    adopt,
    batch_start,
    confirmed,
    leads_to,
    ordered,
    redrawn,
)
from debrisest.filters.landmarks.cost import Unknowns
from debrisest.filters.landmarks.frame_sums import FAR
from debrisest.filters.landmarks.growing_windows import (
    FROM_NEAR,
    PATIENCE,
    Fit,
    Window,
    descend_on,
    fit,
    place,
)
from debrisest.filters.landmarks.residuals import without_far
from debrisest.filters.landmarks.update import Belief
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.rivals import GIVEN_UP
from debrisest.filters.runs import put, take

_GROWTH = 1.5
_ROUNDS = 3
_THIN = 120
"""Frames of a window that is only to find the way."""


class Anchor(NamedTuple):
    """What all frames up to an epoch say, and which landmarks (run, N) they confirm."""

    epoch: int
    start: Belief
    """At epoch 0."""
    belief: Belief
    """At the anchor's epoch."""
    present: BoolArray


class Arc(NamedTuple):
    """Solutions over the whole arc, the frames' anchors, and what was left out of the frames."""

    found: Rivals
    observed: Observations
    anchors: list[Anchor]
    fits: list[Fit]
    """Solution at every anchor."""


def window_ends(first: int, last: int, kept: Sequence[int]) -> list[int]:
    """Return ends of windows from one epoch to another, half as long again each, and the kept ones.

    Every kept epoch after the first end is an end, so that its estimate is that of a window.
    """
    ends = [min(first, last)]
    while ends[-1] < last:
        most = min(int(_GROWTH * ends[-1]), last)
        ends.append(min((k for k in kept if ends[-1] < k <= most), default=most))
    return ends


def whole_arc(task: Problem, ends: Sequence[int]) -> Arc:
    """Estimate all runs over windows from epoch 0 to each of the ends in turn."""
    found, anchors, fits = batch_start(task), [], []
    for i, end in enumerate(ends):
        before = take(found, np.arange(len(task.parameters)))
        found, observed = _over(task, found, end)
        observed = _again(task, found, observed, before, ends[: i + 1])
        fits.append(found.best)
        anchors.append(_anchor(task.model, found.best, end))
    return Arc(found, observed, anchors, fits)


def _over(task: Problem, found: Rivals, end: int) -> tuple[Rivals, Observations]:
    """Both solutions over a longer window, the other one only where it still fits about as well."""
    runs = np.arange(len(task.parameters))
    best, observed = _exact(task, found.best, end)
    alive = np.flatnonzero(found.gap < GIVEN_UP)
    rest = take(best, runs)
    rest.found.value[:] = np.inf
    if len(alive):
        put(rest, alive, _exact(task.of(alive), take(found.other, alive), end)[0])
    swapped = rest.found.value < best.found.value
    found = Rivals(*ordered(best, rest), found.restarts, found.settled)
    if swapped.any():
        observed = without_far(task.model, task.observed, found.best.at, end)
    return found, observed


def _again(
    task: Problem, found: Rivals, observed: Observations, before: Rivals, ends: Sequence[int]
) -> Observations:
    """Begin anew, in place, the runs that do not fit: from mirrors, then from other guesses.

    Returns what is left of the frames.
    """
    batch = task.batch
    for attempt in range(batch.restarts):
        open_still = (found.restarts <= attempt) & ~found.settled
        bad = np.flatnonzero(~batch.accepts(found.best) & open_still)
        if len(bad) == 0:
            break
        part, rival = task.of(bad), take(found.best, bad)
        if attempt == 0 and batch.mirrored:
            begun = _from_mirror(part, take(before.best, bad))
        else:
            begun = redrawn(part, attempt)
            found.settled[bad] = leads_to(begun, rival)
        left, new = _led(part, begun, rival, found.settled[bad], ends)
        found.restarts[np.delete(bad, left)] += 1
        if len(left) == 0:
            continue
        bad, part = bad[left], part.of(left)
        new, kept = _exact(part, new, ends[-1])
        rest = take(new, np.arange(len(bad)))
        rest.found.value[:] = np.inf
        won = adopt(found, bad, new, rest)
        observed = _replaced(observed, bad[won], kept.at(won))
    return observed


def _led(
    task: Problem, begun: Fit, rival: Fit, settled: BoolArray, ends: Sequence[int]
) -> tuple[IntArray, Fit]:
    """Lead fits through windows to the last end; which runs get there, and their fits.

    One that is settled, or whose cost on its way is far higher than its rival's per component, is
    given up.
    """
    ratio = rival.found.value / np.maximum(rival.found.dof, 1)
    runs = np.flatnonzero(~settled & _near(begun, ratio))
    begun = take(begun, runs)
    for end in ends:
        if len(runs) == 0:
            break
        begun = _thin(task.of(runs), begun, end)
        kept = np.flatnonzero(_near(begun, ratio[runs]))
        runs, begun = runs[kept], take(begun, kept)
    return runs, begun


def _near(begun: Fit, ratio: Array) -> BoolArray:
    """Whether the cost of a fit is not far above that of a rival with this cost per component."""
    return np.asarray(~(begun.found.value - begun.found.dof * ratio >= GIVEN_UP))


def _from_mirror(task: Problem, best: Fit) -> Fit:
    """Fit over the first windows from the mirror of a solution."""
    batch = task.batch
    parameters, points = task.model.mirror(best.at.parameters, best.at.points)
    at = Unknowns(parameters, points, best.at.placed.copy())
    windows = batch.windows[1::2] or batch.windows
    return fit(
        *(task.model, task.observed, at, best.prior, windows, batch.iterations, batch.robust)
    )


def _thin(task: Problem, begun: Fit, end: int) -> Fit:
    """Fit over some of the frames of a window."""
    window = Window(end, max(1, end // _THIN))
    model, batch, observed = task.model, task.batch, task.observed
    at, prior = place(model, observed, begun.at, begun.prior, end)
    return descend_on(
        *(model, observed, at, prior, window.frames),
        *(PATIENCE * batch.iterations, batch.robust, FROM_NEAR),
    )


def _exact(task: Problem, begun: Fit, end: int) -> tuple[Fit, Observations]:
    """Fit over all frames of a window, less those that are far from it; and what is left of them.

    The cost counts for each sighting that is left out what it is left out for.
    """
    model, batch, observed = task.model, task.batch, task.observed
    runs = np.arange(len(task.parameters))
    begun = take(begun, runs)
    at, prior = place(model, observed, begun.at, begun.prior, end)
    if batch.robust:
        begun = _thin(task, begun, end)
        at, prior = begun.at, begun.prior
        observed = without_far(model, observed, at, end)
    result = begun._replace(at=at, prior=prior)
    for _ in range(_ROUNDS):
        part, begin = task.of(runs), take(result, runs)
        new = descend_on(
            *(part.model, observed.at(runs), begin.at, begin.prior),
            *(np.arange(end + 1), batch.iterations, False, FROM_NEAR),
        )
        put(result, runs, new)
        runs = runs[new.found.squares_dof < new.found.dof]
        if len(runs) == 0:
            break
        again = without_far(model.of(runs), task.observed.at(runs), take(result.at, runs), end)
        observed = _replaced(observed, runs, again)
    return _counted(task, result, observed, end), observed


def _replaced(observed: Observations, runs: IntArray, new: Observations) -> Observations:
    seen, common_seen = observed.seen.copy(), observed.common_seen.copy()
    seen[runs], common_seen[runs] = new.seen, new.common_seen
    return observed._replace(seen=seen, common_seen=common_seen)


def _counted(task: Problem, found: Fit, kept: Observations, end: int) -> Fit:
    """The same fit, whose sightings and cost count what was left out."""
    until = np.arange(end + 1)
    before, now = task.observed.at(slice(None), until), kept.at(slice(None), until)
    sightings = (before.seen.any(-1) & found.at.placed[:, None]).sum(1)
    lost = (before.seen & ~now.seen).any(-1).sum((-2, -1))
    lost += (before.common_seen & ~now.common_seen).sum((-2, -1))
    value = found.found.value + FAR * lost
    return found._replace(found=found.found._replace(value=value, sightings=sightings))


def _anchor(model: LandmarkModel, found: Fit, end: int) -> Anchor:
    """What a window's solution says at its end, and at epoch 0."""
    present, points = confirmed(found), found.at.points
    covariance = scaled_inverse(found.found.information)
    core, by_parameters = model.start(found.at.parameters)
    start = Belief(core, points, _moved(by_parameters, covariance, present))
    spread = _moved(found.found.by_start, covariance, present)
    return Anchor(end, start, Belief(found.found.last, points, spread), present)


def _moved(by_parameters: Array, covariance: Array, present: BoolArray) -> Array:
    """Covariance of a core's errors and of the landmarks that are there."""
    n_c, n_x = by_parameters.shape[-2:]
    whole = np.zeros((len(present), n_c + covariance.shape[-1] - n_x, covariance.shape[-1]))
    whole[:, :n_c, :n_x] = by_parameters
    whole[:, n_c:, n_x:] = np.repeat(present, 3, axis=-1)[..., None] * np.eye(3 * present.shape[-1])
    return np.asarray(whole @ covariance @ np.swapaxes(whole, -1, -2))
