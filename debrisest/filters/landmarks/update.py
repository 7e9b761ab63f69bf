"""Iterated, gated update of a core and its landmarks with one frame."""

from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.gate import chi_square_limits, group_squares
from debrisest.filters.iterated import iterate
from debrisest.filters.landmark_model import LandmarkModel, Observations
from debrisest.filters.linear_algebra import solve
from debrisest.filters.missing import drop_missing
from debrisest.filters.runs import put, take


class Belief(NamedTuple):
    """Core (run, n), points (run, N, 3), covariance of their errors, zero for absent landmarks."""

    core: Array
    points: Array
    covariance: Array


class UpdateSettings(NamedTuple):
    """How a frame is used."""

    iterations: int = 3
    tolerance: float = 0.1
    """Iterations end once no error moves by this part of its sigma."""
    false_alarm: float | None = 1e-3
    """Probability with which the gate rejects a landmark, or a common row, that was seen well;
    none: no gate."""


class Frame(NamedTuple):
    """Figures of a frame, (run,) each, and which landmarks were accepted, (run, N)."""

    nis: Array
    nis_dof: IntArray
    rejected: IntArray
    accepted: BoolArray
    updates: IntArray


class _Linear(NamedTuple):
    """Innovation (run, m), derivative (run, m, n_e) and noise (run, m, m) at a state."""

    innovation: Array
    response: Array
    noise: Array


class _Step(NamedTuple):
    """``P H^T``, S, the gain, the correction of the prior's state, and ``S^-1 nu``."""

    cross: Array
    total: Array
    gain: Array
    correction: Array
    weighed: Array


def update(
    model: LandmarkModel,
    prior: Belief,
    observed: Observations,
    k: int,
    settings: UpdateSettings,
    inflation: float = 1.0,
) -> tuple[Belief, Frame]:
    """Update with frame k, whose ``observed (run, ...)`` may be masked; noise variance inflated.

    Gauss-Newton steps x_i+1 = x- [+] K_i (nu(x_i) - H_i (x- [-] x_i)). The gate judges each
    landmark, and each common row by itself, by its innovation at x-. The covariance update is
    Joseph's, multiplied out: ``P - K W^T - W K^T`` with ``W = P H^T - K S / 2`` costs a quarter and
    depends on errors of the gain in second order only, too.
    """
    if compiled.available():
        from debrisest.filters.landmarks.compiled_update import compiled_update

        return compiled_update(model, prior, observed, k, settings, inflation)
    linear = _linearise(model, prior.core, prior.points, observed, k, inflation)
    used, accepted = _gated(model, prior, observed, linear, settings)
    rejected = observed.seen.sum((-2, -1)) + observed.common_seen.sum(-1) - used.sum(-1)
    step = _gauss_newton(prior, linear, used)
    innovation = np.where(used, linear.innovation, 0.0)
    nis = (innovation * step.weighed).sum(-1)
    count = _iterate(model, prior, observed, k, settings, inflation, used, step)
    core, points = moved_by(model, prior, step.correction)
    change = step.gain @ np.swapaxes(step.cross - 0.5 * step.gain @ step.total, -1, -2)
    covariance = prior.covariance - change - np.swapaxes(change, -1, -2)
    return Belief(core, points, covariance), Frame(nis, used.sum(-1), rejected, accepted, count)


def _iterate(
    model: LandmarkModel,
    prior: Belief,
    observed: Observations,
    k: int,
    settings: UpdateSettings,
    inflation: float,
    used: BoolArray,
    step: _Step,
) -> IntArray:
    """Go on from the first step, changed in place; number of steps (run,)."""
    variance = np.diagonal(prior.covariance, 0, -2, -1)
    anything = used.any(-1, keepdims=True)

    def again(runs: IntArray) -> None:
        core, points = moved_by(model, prior, step.correction)
        linear = _linearise(model, core, points, observed, k, inflation)
        back = (linear.response @ step.correction[..., None])[..., 0]
        residual = linear.innovation + back
        new = _gauss_newton(prior, linear._replace(innovation=residual), used)
        put(step, runs, take(new, runs))

    def moved(before: Array) -> BoolArray:
        left = variance - (step.cross * step.gain).sum(-1)
        sigma = np.sqrt(np.maximum(left, 1e-12 * np.abs(variance)))
        far = np.abs(step.correction - before) > settings.tolerance * sigma
        return np.asarray((far & anything).any(-1))

    return iterate(step.correction, again, moved, settings.iterations)


def _linearise(
    model: LandmarkModel,
    core: Array,
    points: Array,
    observed: Observations,
    k: int,
    inflation: float,
) -> _Linear:
    rows = model.rows(core[:, None], points[:, None], np.array([k]))
    runs, landmarks, each, n_c = *rows.shown[:, 0].shape, model.errors
    count = landmarks * each
    m = count + model.common
    response = np.zeros((runs, m, n_c + 3 * landmarks))
    response[:, :count, model.shown_by] = rows.by_core.reshape(runs, count, -1)
    row = np.arange(count).reshape(landmarks, each, 1)
    column = n_c + np.arange(3 * landmarks).reshape(landmarks, 1, 3)
    response[:, row, column] = rows.by_point[:, 0]
    response[:, count:, model.shown_by] = rows.common_by_core[:, 0]
    innovation = np.concatenate(
        [
            (observed.shown - rows.shown[:, 0]).reshape(runs, count),
            observed.common - rows.common[:, 0],
        ],
        axis=-1,
    )
    sigma = np.concatenate([np.tile(model.sigma, landmarks), model.common_sigma])
    noise = np.tile(np.diag(sigma**2), (runs, 1, 1))
    if rows.shared.shape[-1]:
        shared = rows.shared.reshape(runs, count, -1)
        noise[:, :count, :count] += shared @ np.swapaxes(shared, -1, -2)
    return _Linear(innovation, response, inflation * noise)


def _gated(
    model: LandmarkModel,
    prior: Belief,
    observed: Observations,
    linear: _Linear,
    settings: UpdateSettings,
) -> tuple[BoolArray, BoolArray]:
    """Components to use (run, m), and landmarks seen that passed (run, N)."""
    runs, landmarks, each = observed.seen.shape
    seen = np.concatenate([observed.seen.reshape(runs, -1), observed.common_seen], axis=-1)
    shown: BoolArray = np.asarray(observed.seen.any(-1))
    if settings.false_alarm is None:
        return seen, shown
    limits = chi_square_limits(settings.false_alarm, each)
    near = _near(prior, linear, slice(landmarks * each, None), limits[1])
    used = seen.copy()
    used[:, landmarks * each :] &= near
    if not shown.any():
        return used, shown
    first = np.arange(landmarks * each).reshape(landmarks, each)
    blocks = _blocks(model, prior, linear, first)
    total = blocks + linear.noise[:, first[:, :, None], first[:, None, :]]
    squares = group_squares(observed.seen, linear.innovation[:, first], total)
    accepted: BoolArray = shown & (squares <= limits[observed.seen.sum(-1)])
    used[:, : landmarks * each] &= np.repeat(accepted, each, axis=-1)
    return used, accepted


def _near(prior: Belief, linear: _Linear, rows: slice, limit: float) -> BoolArray:
    """Whether each of some rows, by its own variance, is near its prediction."""
    response = linear.response[:, rows]
    noise = np.diagonal(linear.noise, 0, -2, -1)[:, rows]
    variance = ((response @ prior.covariance) * response).sum(-1) + noise
    return np.asarray(linear.innovation[:, rows] ** 2 <= limit * variance)


def _blocks(model: LandmarkModel, prior: Belief, linear: _Linear, first: IntArray) -> Array:
    """Covariance (run, N, r, r) of each landmark's predicted components."""
    n_c = model.errors
    response, covariance = linear.response[:, : first.size], prior.covariance
    runs, (landmarks, each) = len(response), first.shape
    spread = (response @ covariance).reshape(runs, landmarks, each, -1)
    by_core = response[..., :n_c].reshape(runs, landmarks, each, n_c)
    column = n_c + np.arange(3 * landmarks).reshape(landmarks, 1, 3)
    by_point = response[:, first[:, :, None], column]
    near = np.take_along_axis(spread, np.broadcast_to(column, (runs, landmarks, each, 3)), axis=-1)
    return np.asarray(
        spread[..., :n_c] @ np.swapaxes(by_core, -1, -2) + near @ np.swapaxes(by_point, -1, -2)
    )


def _gauss_newton(prior: Belief, linear: _Linear, used: BoolArray) -> _Step:
    """Step from the prior, without what is not used."""
    innovation, noise = linear.innovation, linear.noise
    response = np.swapaxes(linear.response, -1, -2)
    if not used.all():
        innovation, response, noise = drop_missing(used, innovation, response, noise)
    cross = prior.covariance @ response
    total = np.swapaxes(response, -1, -2) @ cross + noise
    right = np.concatenate([np.swapaxes(cross, -1, -2), innovation[..., None]], axis=-1)
    solved = solve(total, right)
    gain = np.swapaxes(solved[..., :-1], -1, -2)
    correction = (gain @ innovation[..., None])[..., 0]
    return _Step(cross, total, gain, correction, solved[..., -1])


def moved_by(model: LandmarkModel, prior: Belief, correction: Array) -> tuple[Array, Array]:
    """Core (run, n) and points (run, N, 3) after a correction (run, n_e)."""
    n_c = model.errors
    shift = correction[:, n_c:].reshape(prior.points.shape)
    return model.retract(prior.core, correction[:, :n_c]), prior.points + shift
