"""Maximum a posteriori estimate at every epoch: an iterated filter that is re-anchored by replays.

At the anchors, epochs in geometric progression, Gauss-Newton runs over all measurements so far, so
that no derivative at a superseded state is left in the information; between them an iterated
extended Kalman filter, in information form and in the state's own chart, carries the estimate on.
Nothing is tuned. The measurements are kept, and the average cost of an epoch grows slowly.
"""

from collections.abc import Sequence

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.replay.cost import write_costs
from debrisest.filters.replay.estimates import Estimates, ReplayStatus, empty, finite, write
from debrisest.filters.replay.evidence import Evidence, take, weigh
from debrisest.filters.replay.frame_update import FRAME_ITERATIONS, Belief, Frame, predict, update
from debrisest.filters.replay.gauss_newton import Solution, gauss_newton, move
from debrisest.filters.replay.replay_model import ReplayModel
from debrisest.filters.robust import robust_newton
from debrisest.filters.scaled import scaled_inverse

RATIO = 1.25
"""Of successive anchors; at 1 every epoch is one."""
_START_ANCHORS, _START_ITERATIONS, _ANCHOR_ITERATIONS, _SMOOTHER_ITERATIONS = 2, 12, 4, 30
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
    also: Sequence[int] = (),
    beside: Array | None = None,
) -> Estimates:
    """Estimate a batch of runs from the prior ``(run, n)`` of epoch 0 and its plain covariance.

    `covariance` is (run, n_e, n_e), `measured` (run, time, m) with NaN = not observed; `keep` lists
    the epochs whose covariance is wanted, `also` epochs to replay at besides the anchors. With
    `gate`, outliers are kept out: by their innovation between anchors; at every anchor the
    residuals of all epochs decide again, so that nothing is locked out for good. `beside` (run, n)
    is a state of epoch 0, such as the truth, whose cost is wanted at the kept epochs beside that of
    the estimate; no estimate depends on it.
    """
    _require_shapes(model, prior, covariance, measured, ratio)
    with np.errstate(all="ignore"):
        evidence = weigh(model, prior, covariance, measured)
        result = empty((*measured.shape[:2], prior.shape[-1]), len(model.error_names), keep)
        _filter(model, evidence, _schedule(evidence, ratio, also), gate, result, beside)
    return result


def smooth(
    model: ReplayModel,
    prior: Array,
    covariance: Array,
    measured: Array,
    filtered: Estimates,
    gate: bool = False,
    keep: Sequence[int] = (),
    beside: Array | None = None,
) -> Estimates:
    """Return the maximum a posteriori motion given all measurements.

    Gauss-Newton to convergence, from where `replay` of the same data ended. `cost` and
    `cost_beside` are set at the last epoch only; `nis` is that of the filter.
    """
    last = measured.shape[1] - 1
    result = empty(filtered.state.shape, len(model.error_names), keep)
    result.nis[:], result.nis_dof[:] = filtered.nis, filtered.nis_dof
    result.status[:], result.diverged_at[:] = filtered.status, filtered.diverged_at
    runs = np.flatnonzero(filtered.diverged_at < 0)
    with np.errstate(all="ignore"):
        evidence = take(weigh(model, prior, covariance, measured), runs)
        start = model.rewind(filtered.state[runs, last], last)
        if gate:
            solution = robust_newton(model, evidence, [start], last, last, _SMOOTHER_ITERATIONS)
        else:
            solution = gauss_newton(model, evidence, start, last, _SMOOTHER_ITERATIONS)
        best = move(model, solution.at.state, solution.step)
        states, sensitivity = model.trajectory(best, 0, last)
        spread = scaled_inverse(solution.at.information)
        for k in range(last + 1):
            transition = model.transition(sensitivity[:, k], 0, k)
            moved = transition @ spread @ np.swapaxes(transition, -1, -2)
            write(result, k, runs, states[:, k], moved)
        write_costs(model, result, last, runs, evidence, (best, beside))
    _judge(result, runs, solution)
    return result


def anchors(first: int, epochs: int, ratio: float = RATIO) -> list[int]:
    """Epochs of the replays from the first measured one on: 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, ..."""
    result, count = [], 1.0
    while first + round(count) - 1 < epochs:
        result.append(first + round(count) - 1)
        count = max(count + 1.0, count * ratio)
    return result


def _schedule(evidence: Evidence, ratio: float, also: Sequence[int]) -> list[int]:
    """Epochs of the replays; the first of them is the first that any run has measurements of."""
    epochs = evidence.seen.shape[1]
    measured = np.flatnonzero(evidence.seen.any(axis=(0, 2)))
    first = int(measured[0]) if len(measured) else epochs
    return sorted({*anchors(first, epochs, ratio), *(k for k in also if first <= k < epochs)})


def _filter(
    model: ReplayModel,
    evidence: Evidence,
    schedule: list[int],
    gate: bool,
    result: Estimates,
    beside: Array | None,
) -> None:
    back = model.inverse_chart(evidence.prior)
    belief = Belief(evidence.prior, np.swapaxes(back, -1, -2) @ evidence.information @ back)
    runs = np.flatnonzero(finite(*belief))
    evidence, belief = take(evidence, runs), take(belief, runs)
    result.diverged_at[runs], result.status[runs] = -1, ReplayStatus.CONVERGED
    for k in range(result.state.shape[1]):
        if k > 0:
            belief = predict(model, belief, k)
        anchored = k in schedule
        belief, frame = update(
            model, belief, evidence, k, 1 if anchored else FRAME_ITERATIONS, gate
        )
        if anchored:
            belief, solution = _replayed(model, belief, evidence, k, schedule, gate)
            result.cost[runs, k] = solution.cost
            _judge(result, runs, solution)
        sound = finite(*belief)
        if not sound.all():
            lost, kept = runs[~sound], np.flatnonzero(sound)
            result.status[lost], result.diverged_at[lost] = ReplayStatus.DIVERGED, k
            runs, belief, evidence = runs[kept], take(belief, kept), take(evidence, kept)
            frame = take(frame, kept)
        _record(model, result, k, runs, belief, frame)
        if k in result.kept:
            motions = model.rewind(belief.state, k), beside
            write_costs(model, result, k, runs, evidence, motions)


def _record(
    model: ReplayModel, result: Estimates, k: int, runs: IntArray, belief: Belief, frame: Frame
) -> None:
    back = model.inverse_chart(belief.state)
    spread = back @ scaled_inverse(belief.information) @ np.swapaxes(back, -1, -2)
    write(result, k, runs, belief.state, spread)
    result.nis[runs, k], result.nis_dof[runs, k] = frame.nis, frame.dof
    result.rejected[runs, k] = frame.rejected


def _judge(result: Estimates, runs: IntArray, solution: Solution) -> None:
    result.status[runs] = np.where(
        solution.converged, ReplayStatus.CONVERGED, ReplayStatus.NOT_CONVERGED
    )


def _replayed(
    model: ReplayModel, belief: Belief, evidence: Evidence, k: int, schedule: list[int], gate: bool
) -> tuple[Belief, Solution]:
    """Belief of epoch k by a replay of everything measured so far."""
    number = schedule.index(k)
    starts = [] if number == 0 else [model.rewind(belief.state, k)]
    if number == 0 or (gate and number < _FRESH_STARTS):
        shown = np.where(evidence.seen[:, k], evidence.measured[:, k], np.nan)
        starts.append(model.start(evidence.prior, shown * model.sigma, k))
    iterations = _START_ITERATIONS if number < _START_ANCHORS else _ANCHOR_ITERATIONS
    if gate:
        solution = robust_newton(model, evidence, starts, k, k - schedule[0] + 1, iterations)
    else:
        solution = gauss_newton(model, evidence, starts[0], k, iterations)
    at = solution.at
    transition = model.transition(at.last_sensitivity, 0, k)
    to_chart = model.chart(at.last_state) @ transition
    state = model.retract(at.last_state, (to_chart @ solution.step[..., None])[..., 0])
    back = np.linalg.inv(transition) @ model.inverse_chart(at.last_state)
    return Belief(state, np.swapaxes(back, -1, -2) @ at.information @ back), solution


def _require_shapes(
    model: ReplayModel, prior: Array, covariance: Array, measured: Array, ratio: float
) -> None:
    runs, n_e, m = len(prior), len(model.error_names), len(model.sigma)
    if covariance.shape != (runs, n_e, n_e) or measured.shape[::2] != (runs, m):
        raise ValueError(
            f"{runs} runs with {n_e} error names and {m} measurements need a covariance of shape "
            f"({runs}, {n_e}, {n_e}) and measurements of shape ({runs}, time, {m}), "
            f"not {covariance.shape} and {measured.shape}"
        )
    if not ratio >= 1.0:
        raise ValueError(f"the ratio of the anchors must be at least 1, not {ratio}")
