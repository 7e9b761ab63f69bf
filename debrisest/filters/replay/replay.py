"""Maximum a posteriori estimate at every epoch: an iterated filter that is re-anchored by replays.

At the anchors, epochs in geometric progression, those whose covariance is kept, and the last,
Gauss-Newton runs over all measurements so far, so that no derivative at a superseded state is left
in the information; between them an iterated extended Kalman filter, in information form and in the
state's own chart, carries the estimate on. Nothing is tuned. The measurements are kept, and the
average cost of an epoch grows slowly. Where the model has a mirror, another solution competes.
"""

from collections.abc import Sequence

import numpy as np

from debrisest.arrays import Array, BoolArray, Data, IntArray
from debrisest.filters.estimates import Estimates, EstimatesWriter, joined
from debrisest.filters.linear_algebra import inverse_of_some_rows, scaled_inverse
from debrisest.filters.replay.cost import Reference, reference_of
from debrisest.filters.replay.frame_update import (
    Belief,
    covariance_of,
    first_frame,
    predict,
    update,
)
from debrisest.filters.replay.gauss_newton import CONVERGED, Solution, move
from debrisest.filters.replay.measured_arc import MeasuredArc, measured_arc
from debrisest.filters.replay.rival import compete, no_rival
from debrisest.filters.replay.search import Search
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.runs import take
from debrisest.filters.status import ReplayStatus

RATIO = 1.25
"""Of successive anchors; at 1 every epoch is one."""
_IN_PASSING = 0.25
"""Of anchors whose result is not kept, the predicted decrease of the cost below which the step is
taken without another look: what it leaves undone is of second order, below 0.01 in general."""
_FRESH_STARTS = 3
"""Anchors at which, with a gate, a start from their own epoch competes with the filter's."""


def replay(
    model: ReplayModel,
    prior: Array,
    covariance: Array,
    measured: Array,
    ratio: float = RATIO,
    gate: bool = False,
    keep: Sequence[int] = (),
    reference: Array | None = None,
) -> Estimates:
    """Estimate a batch of runs from the prior ``(run, n)`` of epoch 0 and its plain covariance.

    `covariance` is (run, n_e, n_e), `measured` (run, time, m) with NaN = not observed; `keep` lists
    the epochs whose covariance is wanted. With `gate`, outliers are kept out: by their innovation
    between anchors; at every anchor the residuals of all epochs decide again, so that nothing is
    locked out for good. `reference` (run, n) is a state of epoch 0, the truth, whose cost is wanted
    at the kept epochs as well, by the same measurements; no estimate depends on it.

    NIS is the rise of the least cost by what an epoch shows, after all iterations of its update; of
    the first measured epoch it is the least cost itself. The status speaks of the last epoch.

    Counts are `cost`, at anchors, and by how much the other solution's is higher (`rival_excess`),
    `cost_of_truth` at kept epochs, and `rejected`.
    """
    _require_shapes(model, prior, measured, ratio)
    groups = _begun_together(measured)
    if len(groups) > 1:
        found = [
            replay(
                *(model.of(runs), prior[runs], covariance[runs], measured[runs], ratio, gate, keep),
                None if reference is None else reference[runs],
            )
            for runs in groups
        ]
        return joined(groups, found)
    epochs, counts = measured.shape[1], {"cost": np.nan, "rival_excess": np.nan}
    counts |= {"rejected": 0} if gate else {}
    counts |= {} if reference is None else {"cost_of_truth": np.nan}
    known = covariance, epochs, keep, counts
    writer = EstimatesWriter(model.error_names, prior, *known, outcomes=ReplayStatus)
    with np.errstate(all="ignore"):
        arc = measured_arc(model, prior, covariance, measured)
        beside = None if reference is None else reference_of(model, arc, reference)
        _filter(model, arc, _schedule(arc, ratio, [*keep, epochs - 1]), gate, writer, beside)
    return writer.estimates()


def smooth(
    model: ReplayModel,
    prior: Array,
    covariance: Array,
    measured: Array,
    filtered: Estimates,
    gate: bool = False,
    keep: Sequence[int] = (),
    reference: Array | None = None,
) -> Estimates:
    """Return the maximum a posteriori motion given all measurements.

    Gauss-Newton to convergence, from where `replay` of the same data ended. `cost` and
    `cost_of_truth` are set at the last epoch only; `nis` and `rejected` are the filter's.
    """
    last = measured.shape[1] - 1
    end = filtered.state[:, last], filtered.covariance[:, -1]
    counts = {"cost": np.nan} | ({} if reference is None else {"cost_of_truth": np.nan})
    writer = EstimatesWriter(model.error_names, *end, last + 1, keep, counts, outcomes=ReplayStatus)
    if len(writer.runs):
        _smooth(model.of(writer.runs), prior, covariance, measured, end[0], gate, writer, reference)
    found = writer.estimates()
    return found._replace(
        nis=filtered.nis,
        nis_dof=filtered.nis_dof,
        status=np.where(filtered.diverged_at < 0, found.status, filtered.status),
        counts=filtered.counts | found.counts,
    )


def _smooth(
    model: ReplayModel,
    prior: Array,
    covariance: Array,
    measured: Array,
    end: Array,
    gate: bool,
    writer: EstimatesWriter,
    reference: Array | None,
) -> None:
    """Write the motion of the writer's runs, of which `model` is, from the filter's last states."""
    last = measured.shape[1] - 1
    with np.errstate(all="ignore"):
        arc = take(measured_arc(model, prior, covariance, measured), writer.runs)
        start = model.rewind(end[writer.runs], last)
        solution = Search(last, last, gate).solve(model, arc, [start])
        best = move(model, solution.at.state, solution.step)
        states, sensitivity = model.trajectory(best, 0, last)
        spread = scaled_inverse(solution.at.information)
        for k in range(last + 1):
            transition = model.transition(sensitivity[:, k], 0, k)
            writer.write(k, states[:, k], transition @ spread @ np.swapaxes(transition, -1, -2))
        writer.count(last, {"cost": solution.cost})
        if reference is not None:
            beside = reference_of(model, arc, reference[writer.runs])
            writer.count(last, {"cost_of_truth": beside.cost(arc.weight, last)})
    writer.conclude(_status(solution))


def anchors(first: int, epochs: int, ratio: float = RATIO) -> list[int]:
    """Epochs of the replays from the first measured one on: 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, ..."""
    result, count = [], 1.0
    while first + round(count) - 1 < epochs:
        result.append(first + round(count) - 1)
        count = max(count + 1.0, count * ratio)
    return result


def _begun_together(measured: Array) -> list[IntArray]:
    """Runs by the epoch of their first measurement, from which their anchors count."""
    seen: BoolArray = np.asarray(~np.isnan(measured).all(-1))
    first = np.where(seen.any(1), seen.argmax(1), measured.shape[1])
    return [np.flatnonzero(first == epoch) for epoch in np.unique(first)]


def _schedule(arc: MeasuredArc, ratio: float, also: Sequence[int]) -> list[int]:
    """Epochs of the replays, ``also`` among them; the first is the first that any run measured."""
    epochs = arc.seen.shape[1]
    measured = np.flatnonzero(arc.seen.any(axis=(0, 2)))
    first = int(measured[0]) if len(measured) else epochs
    return sorted({*anchors(first, epochs, ratio), *(k for k in also if first <= k < epochs)})


def _filter(
    model: ReplayModel,
    arc: MeasuredArc,
    schedule: list[int],
    gate: bool,
    writer: EstimatesWriter,
    reference: Reference | None,
) -> None:
    going = writer.runs
    back = model.inverse_chart(arc.prior)
    belief = Belief(arc.prior, np.swapaxes(back, -1, -2) @ arc.information @ back)
    rival = no_rival(model, arc)
    for k in range(arc.measured.shape[1]):
        if len(going) == 0:
            break
        if len(going) < len(belief.state):
            model, belief, arc = model.of(going), take(belief, going), take(arc, going)
            rival = take(rival, going)
            reference = None if reference is None else take(reference, going)
        if k > 0:
            belief = predict(model, belief, k)
        belief, frame = update(model, belief, arc, k, gate)
        figures: Data = frame._asdict()
        if k in schedule:
            tolerance = CONVERGED if writer.keeps(k) else _IN_PASSING
            search = Search(k, k - schedule[0] + 1, gate, tolerance)
            solution = search.solve(model, arc, _starts(model, belief, arc, k, schedule, gate))
            compete(search, model, arc, solution, rival, writer.keeps(k))
            belief = _belief(model, solution, k)
            figures |= {"cost": solution.cost, "rival_excess": rival.gap}
            writer.conclude(_status(solution))
            if k == schedule[0]:
                figures |= first_frame(model, arc, solution, k)._asdict()
            if reference is not None and writer.keeps(k):
                figures["cost_of_truth"] = reference.cost(arc.weight, k)
        going = writer.record(k, belief.state, covariance_of(model, belief), figures)


def _status(solution: Solution) -> IntArray:
    return np.where(solution.converged, ReplayStatus.CONVERGED, ReplayStatus.NOT_CONVERGED)


def _starts(
    model: ReplayModel, belief: Belief, arc: MeasuredArc, k: int, schedule: list[int], gate: bool
) -> list[Array]:
    """States at epoch 0 from which the replay of epoch k begins."""
    number = schedule.index(k)
    starts = [] if number == 0 else [model.rewind(belief.state, k)]
    if number == 0 or (gate and number < _FRESH_STARTS):
        shown = np.where(arc.seen[:, k], arc.measured[:, k], np.nan)
        starts.append(model.start(arc.prior, shown * model.sigma, k))
    return starts


def _belief(model: ReplayModel, solution: Solution, k: int) -> Belief:
    """Belief of epoch k by everything measured so far."""
    at = solution.at
    transition = model.transition(at.last_sensitivity, 0, k)
    if model.frames is not None:
        state = move(model, at.last_state, (transition @ solution.step[..., None])[..., 0])
        known = at.state, at.last_state, at.information, at.last_sensitivity
        return Belief(state, model.frames.carry(*known, 0, k, True))
    to_chart = model.chart(at.last_state) @ transition
    state = model.retract(at.last_state, (to_chart @ solution.step[..., None])[..., 0])
    back = inverse_of_some_rows(transition) @ model.inverse_chart(at.last_state)
    return Belief(state, np.swapaxes(back, -1, -2) @ at.information @ back)


def _require_shapes(model: ReplayModel, prior: Array, measured: Array, ratio: float) -> None:
    runs, m = len(prior), len(model.sigma)
    if measured.shape[::2] != (runs, m):
        raise ValueError(
            f"{runs} runs with {m} measurements need an array of shape ({runs}, time, {m}), "
            f"not {measured.shape}"
        )
    if not ratio >= 1.0:
        raise ValueError(f"the ratio of the anchors must be at least 1, not {ratio}")
