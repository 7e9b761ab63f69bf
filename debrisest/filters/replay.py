"""Maximum a posteriori estimate at every epoch: an iterated filter that is re-anchored by replays.

At the anchors, epochs in geometric progression, Gauss-Newton runs over all measurements so far, so
that no derivative at a superseded state is left in the information; between them an iterated
extended Kalman filter, in information form and in the state's own chart, carries the estimate on.
Nothing is tuned. The measurements are kept, and the average cost of an epoch grows slowly.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters import robust
from debrisest.filters.gauss_newton import (
    Evidence,
    Solution,
    gauss_newton,
    linearize,
    move,
    normal_equations,
    scaled_inverse,
    scaled_solve,
    take,
    weigh,
)
from debrisest.filters.replay_estimates import Estimates, ReplayStatus, empty, finite, write
from debrisest.filters.replay_model import ReplayModel

RATIO = 1.25
"""Of successive anchors; at 1 every epoch is one."""
_START_ANCHORS, _START_ITERATIONS, _ANCHOR_ITERATIONS, _SMOOTHER_ITERATIONS = 2, 12, 4, 30
_FRAME_ITERATIONS, _FRAME_CONVERGED = 3, 1e-3
_ROBUST_START, _SOFT_FRAMES, _PASSES = 10, 3, 3


class _Belief(NamedTuple):
    """State (run, n), and information (run, n_e, n_e) in the state's own chart."""

    state: Array
    information: Array


class _Frame(NamedTuple):
    """Figures of one epoch, (run,) each."""

    nis: Array
    dof: IntArray
    rejected: IntArray


def replay(
    model: ReplayModel,
    prior: Array,
    covariance: Array,
    measured: Array,
    ratio: float = RATIO,
    gate: bool = False,
    keep: Sequence[int] = (),
) -> Estimates:
    """Estimate a batch of runs from the prior ``(run, n)`` of epoch 0 and its plain covariance.

    `covariance` is (run, n_e, n_e), `measured` (run, time, m) with NaN = not observed; `keep` lists
    the epochs whose covariance is wanted. With `gate`, outliers are kept out: by their innovation
    between anchors; at every anchor the residuals of all epochs decide again, so that nothing is
    locked out for good and an outlier of the first epoch is found later.
    """
    _require_shapes(model, prior, covariance, measured, ratio)
    with np.errstate(all="ignore"):
        evidence = weigh(model, prior, covariance, measured)
        result = empty((*measured.shape[:2], prior.shape[-1]), len(model.error_names), keep)
        _filter(model, evidence, ratio, gate, result)
    return result


def smooth(
    model: ReplayModel,
    prior: Array,
    covariance: Array,
    measured: Array,
    filtered: Estimates,
    gate: bool = False,
    keep: Sequence[int] = (),
) -> Estimates:
    """Return the maximum a posteriori motion given all measurements.

    Gauss-Newton to convergence, from where `replay` of the same data ended. `cost` is set at the
    last epoch only; `nis` is that of the filter.
    """
    last = measured.shape[1] - 1
    result = empty(filtered.state.shape, len(model.error_names), keep)
    result.nis[:], result.nis_dof[:] = filtered.nis, filtered.nis_dof
    result.status[:], result.diverged_at[:] = filtered.status, filtered.diverged_at
    runs = np.flatnonzero(filtered.diverged_at < 0)
    with np.errstate(all="ignore"):
        evidence = take(weigh(model, prior, covariance, measured), runs)
        start = model.rewind(filtered.state[runs, last], last)
        solution = _anchor(model, evidence, start, last, last, _SMOOTHER_ITERATIONS, gate)
        best = move(model, solution.at.state, solution.step)
        states, sensitivity = model.trajectory(best, 0, last)
        spread = scaled_inverse(solution.at.information)
        for k in range(last + 1):
            transition = model.transition(sensitivity[:, k], 0, k)
            moved = transition @ spread @ np.swapaxes(transition, -1, -2)
            write(result, k, runs, states[:, k], moved)
    result.cost[runs, last] = solution.cost
    _judge(result, runs, solution)
    return result


def anchors(first: int, epochs: int, ratio: float = RATIO) -> list[int]:
    """Epochs of the replays from the first measured one on: 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, ..."""
    result, count = [], 1.0
    while first + round(count) - 1 < epochs:
        result.append(first + round(count) - 1)
        count = max(count + 1.0, count * ratio)
    return result


def _filter(
    model: ReplayModel, evidence: Evidence, ratio: float, gate: bool, result: Estimates
) -> None:
    epochs = result.state.shape[1]
    observed = np.flatnonzero(evidence.weight.any(axis=(0, 2)))
    first = int(observed[0]) if len(observed) else epochs
    schedule = anchors(first, epochs, ratio)
    back = model.inverse_chart(evidence.prior)
    belief = _Belief(evidence.prior, np.swapaxes(back, -1, -2) @ evidence.information @ back)
    runs = np.flatnonzero(finite(*belief))
    evidence, belief = take(evidence, runs), take(belief, runs)
    result.diverged_at[runs], result.status[runs] = -1, ReplayStatus.CONVERGED
    for k in range(epochs):
        if k > 0:
            belief = _predict(model, belief, k)
        anchored = k in schedule
        belief, frame = _update(
            model, belief, evidence, k, 1 if anchored else _FRAME_ITERATIONS, gate
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


def _record(
    model: ReplayModel, result: Estimates, k: int, runs: IntArray, belief: _Belief, frame: _Frame
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


def _predict(model: ReplayModel, belief: _Belief, k: int) -> _Belief:
    """Belief of epoch k from that of k - 1."""
    states, sensitivity = model.trajectory(belief.state, k - 1, k)
    state = states[:, -1]
    transition = model.transition(sensitivity[:, -1], k - 1, k)
    back = model.chart(belief.state) @ np.linalg.inv(transition) @ model.inverse_chart(state)
    return _Belief(state, np.swapaxes(back, -1, -2) @ belief.information @ back)


def _update(
    model: ReplayModel, predicted: _Belief, evidence: Evidence, k: int, iterations: int, gate: bool
) -> tuple[_Belief, _Frame]:
    """Iterated update with the measurements of epoch k, each run until it has converged.

    With `gate`, the weights of the epoch's rejected rows are set to zero in `evidence`.
    """
    frame = slice(k, k + 1)
    state, information = predicted.state.copy(), predicted.information.copy()
    runs = np.arange(len(state))
    for iteration in range(iterations):
        at = state[runs]
        states, sensitivity = model.trajectory(at, k, k)
        shown, derivative = model.rows(states, sensitivity, k, np.array([k]))
        back = model.inverse_chart(at)
        rows = derivative / model.sigma[:, None] @ back[:, None]
        residual = evidence.measured[runs, frame] - shown / model.sigma
        if gate and iteration == 0:
            spread = scaled_inverse(predicted.information)[:, None]
            evidence.weight[:, frame] *= robust.innovation_gate(residual, rows, spread)
        terms = normal_equations(rows, residual, evidence.weight[runs, frame])
        total = predicted.information[runs] + terms[0]
        offset = model.difference(predicted.state[runs], at)
        right = terms[1] + (predicted.information[runs] @ offset[..., None])[..., 0]
        step = scaled_solve(total, right)
        decrement = (step * right).sum(-1)
        if iteration == 0:
            nis = terms[2] - decrement
        state[runs], information[runs] = model.retract(at, step), total
        runs = runs[~(decrement < _FRAME_CONVERGED)]
        if len(runs) == 0:
            break
    used = (evidence.weight[:, k] > 0.0).sum(-1)
    return _Belief(state, information), _Frame(nis, used, evidence.seen[:, k].sum(-1) - used)


def _replayed(
    model: ReplayModel, belief: _Belief, evidence: Evidence, k: int, schedule: list[int], gate: bool
) -> tuple[_Belief, Solution]:
    """Belief of epoch k by a replay of everything measured so far."""
    number = schedule.index(k)
    if number == 0:
        shown = np.where(evidence.seen[:, k], evidence.measured[:, k], np.nan)
        start = model.start(evidence.prior, shown * model.sigma, k)
    else:
        start = model.rewind(belief.state, k)
    iterations = _START_ITERATIONS if number < _START_ANCHORS else _ANCHOR_ITERATIONS
    frames = k - schedule[0] + 1
    solution = _anchor(model, evidence, start, k, frames, iterations, gate)
    at = solution.at
    transition = model.transition(at.last_sensitivity, 0, k)
    to_chart = model.chart(at.last_state) @ transition
    state = model.retract(at.last_state, (to_chart @ solution.step[..., None])[..., 0])
    back = np.linalg.inv(transition) @ model.inverse_chart(at.last_state)
    return _Belief(state, np.swapaxes(back, -1, -2) @ at.information @ back), solution


def _anchor(
    model: ReplayModel,
    evidence: Evidence,
    start: Array,
    k: int,
    frames: int,
    iterations: int,
    gate: bool,
) -> Solution:
    """Gauss-Newton over epochs 0 to k; with `gate`, weights and estimate are found in turns."""
    if not gate:
        return gauss_newton(model, evidence, start, k, iterations)
    seen = evidence.seen[:, : k + 1]
    residual = linearize(model, evidence, start, k).residual
    passes = [robust.cauchy] * (_PASSES if frames <= _ROBUST_START else 1)
    passes.append(robust.cauchy if frames <= _SOFT_FRAMES else robust.hard)
    for weights in passes:
        evidence.weight[:, : k + 1] = seen * weights(residual)
        solution = gauss_newton(model, evidence, start, k, iterations)
        start, residual = move(model, solution.at.state, solution.step), solution.at.residual
    return solution


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
