"""Iterated extended Kalman filter in information form, in the state's own chart."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters import weights
from debrisest.filters.linear_algebra import inverse_of_some_rows, scaled_inverse, scaled_solve
from debrisest.filters.replay.gauss_newton import Solution
from debrisest.filters.replay.measured_arc import MeasuredArc, residuals, sums
from debrisest.filters.replay_model import ReplayModel

_ITERATIONS, _CONVERGED = 3, 1e-3


class Belief(NamedTuple):
    """State (run, n), and information (run, n_e, n_e) in the state's own chart."""

    state: Array
    information: Array


class Frame(NamedTuple):
    """Figures of one epoch, (run,) each."""

    nis: Array
    nis_dof: IntArray
    rejected: IntArray


def predict(model: ReplayModel, belief: Belief, k: int) -> Belief:
    """Belief of epoch k from that of k - 1."""
    states, sensitivity = model.trajectory(belief.state, k - 1, k)
    state = states[:, -1]
    if model.frames is not None:
        moved = belief.state, state, belief.information, sensitivity[:, -1]
        return Belief(state, model.frames.carry(*moved, k - 1, k, False))
    transition = model.transition(sensitivity[:, -1], k - 1, k)
    inverse = inverse_of_some_rows(transition)
    back = model.chart(belief.state) @ inverse @ model.inverse_chart(state)
    return Belief(state, np.swapaxes(back, -1, -2) @ belief.information @ back)


def update(
    model: ReplayModel, predicted: Belief, arc: MeasuredArc, k: int, gate: bool
) -> tuple[Belief, Frame]:
    """Iterated update with the measurements of epoch k, each run until it has converged.

    In information form a step also promises its decrease of the cost, which says when to end: apart
    from `debrisest.filters.iterated`, which asks by how much a gain moves the state. NIS is the
    cost that is left in the end.

    With `gate`, the weights of the epoch's rejected rows are set to zero in `arc`.
    """
    frame = slice(k, k + 1)
    state, information = predicted.state.copy(), predicted.information.copy()
    if model.frames is not None:
        measured, weight = arc.measured[:, k].copy(), arc.weight[:, k].copy()
        own = state, information, k, measured, weight, gate
        nis = model.frames.update(*own, (_ITERATIONS, _CONVERGED))
        arc.weight[:, k] = weight
        return Belief(state, information), _frame(arc, k, nis)
    runs, nis = np.arange(len(state)), np.empty(len(state))
    for iteration in range(_ITERATIONS):
        at = state[runs]
        part = model.of(runs)
        place = *part.trajectory(at, k, k), k, np.array([k])
        back = part.inverse_chart(at)
        if gate and iteration == 0:
            shown, derivative = part.rows(*place)
            residual, rows = (
                arc.measured[:, frame] - shown / model.sigma,
                derivative @ back[:, None],
            )
            spread = scaled_inverse(predicted.information)[:, None]
            rows /= model.sigma[:, None]
            arc.weight[:, frame] *= weights.innovation_gate(residual, rows, spread)
        terms = sums(part, place, arc.measured[runs, frame], arc.weight[runs, frame])
        to_plain = np.swapaxes(back, -1, -2)
        total = predicted.information[runs] + to_plain @ terms[0] @ back
        offset = part.difference(predicted.state[runs], at)
        pull = (predicted.information[runs] @ offset[..., None])[..., 0]
        right = (to_plain @ terms[1][..., None])[..., 0] + pull
        step = scaled_solve(total, right)
        decrement = (step * right).sum(-1)
        nis[runs] = terms[2] + (offset * pull).sum(-1) - decrement
        state[runs], information[runs] = part.retract(at, step), total
        runs = runs[~(decrement < _CONVERGED)]
        if len(runs) == 0:
            break
    return Belief(state, information), _frame(arc, k, nis)


def covariance_of(model: ReplayModel, belief: Belief) -> Array:
    """Return the plain covariance (run, n_e, n_e)."""
    if model.frames is not None:
        return model.frames.covariance(*belief)
    back = model.inverse_chart(belief.state)
    return back @ scaled_inverse(belief.information) @ np.swapaxes(back, -1, -2)


def _frame(arc: MeasuredArc, k: int, nis: Array) -> Frame:
    used = (arc.weight[:, k] > 0.0).sum(-1)
    return Frame(nis, used, arc.seen[:, k].sum(-1) - used)


def first_frame(model: ReplayModel, arc: MeasuredArc, solution: Solution, k: int) -> Frame:
    """Figures of the first measured epoch by its replay, since no update comes so far at once.

    What would be rejected there does not count, whatever its weight.
    """
    residual = residuals(model, arc, model.shown(solution.at.state, k)[1])[:, k]
    used = arc.seen[:, k] & ((arc.weight[:, k] == 1.0) | (weights.hard(residual) > 0.0))
    weight = np.where(used, 1.0 - arc.weight[:, k] ** 2, -(arc.weight[:, k] ** 2))
    nis = solution.cost + (weight * residual**2).sum(-1)
    return Frame(nis, used.sum(-1), (arc.seen[:, k] & ~used).sum(-1))
