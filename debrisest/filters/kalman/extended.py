"""Extended and iterated extended Kalman filter, batched over runs."""

from collections.abc import Sequence
from typing import Literal, NamedTuple, get_args

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray, Data, IntArray
from debrisest.filters.estimates import Estimates, EstimatesWriter
from debrisest.filters.gate import Gate, Gatekeeper
from debrisest.filters.iterated import iterate
from debrisest.filters.kalman import jacobian
from debrisest.filters.linear_algebra import solve
from debrisest.filters.missing import drop_missing
from debrisest.filters.model import Model
from debrisest.filters.runs import put

Stop = Literal["relative_norm", "scaled"]

_SMALLEST_RATIO = 1e-12


class _UpdateSettings(NamedTuple):
    iterations: int
    tolerance: float
    stop: Stop
    loops: bool
    """Whether steps are compiled, which want noises that are independent."""


class _Prior(NamedTuple):
    k: int
    state: Array
    covariance: Array
    y: Array
    used: BoolArray

    def of(self, runs: IntArray) -> "_Prior":
        """Return the same of some runs."""
        return _Prior(
            self.k, self.state[runs], self.covariance[runs], self.y[runs], self.used[runs]
        )


class _Step(NamedTuple):
    """One Gauss-Newton step: the correction of x-, the posterior's variances, NIS.

    Its posterior follows from two more, H^T and K^T or what loops give.
    """

    parts: tuple[Array, Array]
    correction: Array
    variance: Array
    nis: Array


def extended(
    model: Model,
    state: Array,
    covariance: Array,
    measurements: Array,
    *,
    iterations: int = 1,
    tolerance: float = 1e-2,
    stop: Stop = "scaled",
    keep: Sequence[int] = (),
    gate: Gate | None = None,
) -> Estimates:
    """Filter a batch of runs; one iteration is the extended Kalman filter, more the iterated one.

    `state` (run, n) and `covariance` (run, n_e, n_e) are the prior of epoch 0, which measurement 0
    updates; `measurements` (run, time, m), NaN = not observed; `keep` lists the epochs whose full
    covariance is wanted. Process noise is added per step; the covariance update is Joseph's, or
    where there are loops the square of a root.

    An update takes up to `iterations` Gauss-Newton steps (Bell and Cathey 1993)
    x_i+1 = x- [+] K_i (nu(y, h(x_i)) - H_i (x- [-] x_i)), linearised at x_i. Every run stops by
    itself once its step from x_i to x_i+1 is short:

    * `"scaled"`: each error component below `tolerance` of its posterior sigma;
    * `"relative_norm"`: ``|x_i+1 - x_i| / |x_i+1|`` below `tolerance`, the rule of Pesce et al.
      (2017). Their 0.01 "percentage variation" is 1e-4 here; with 1e-2 a distant target is never
      iterated.

    The fixed point is the maximum of the posterior. Where errors are curved, P- is taken over from
    x- to x_i as it is, as any extended filter does from x- to its estimate.

    A `gate` judges the innovations at x- and has those that it rejects treated as not observed;
    NIS counts the others, where a gate reopened with the prior that it doubted and enlarged. It is
    what the last step leaves of the cost: linearised at x-, a far prior gives a figure that says
    nothing of the fit.
    """
    settings = _settings(model, iterations, tolerance, stop)
    epochs, components = measurements.shape[1:]
    keeper = None if gate is None else Gatekeeper(gate, model.gate_groups, covariance, components)
    counts, totals = {"updates": 0}, ["repairs"]
    if gate is not None:
        counts, totals = counts | {"rejected": 0}, [*totals, "reopened"]
    names = model.error_names
    writer = EstimatesWriter(names, state, covariance, epochs, keep, counts, totals)
    going = writer.runs
    with np.errstate(all="ignore"):
        for k in range(epochs):
            if len(going) < len(state):
                model, state, covariance = model.of(going), state[going], covariance[going]
                measurements = measurements[going]
                keeper = None if keeper is None else keeper.of(going)
            if len(going) == 0:
                break
            if k > 0:
                state, covariance = _predict(model, state, covariance, k - 1)
            y = measurements[:, k]
            prior = _Prior(k, state, covariance, y, ~np.isnan(y))
            state, covariance, figures = _update(model, settings, keeper, prior)
            going = writer.record(k, state, covariance, figures)
    return writer.estimates()


def _settings(model: Model, iterations: int, tolerance: float, stop: Stop) -> _UpdateSettings:
    if iterations < 1 or not tolerance > 0.0 or stop not in get_args(Stop):
        raise ValueError(
            f"at least one iteration, a positive tolerance and one of {get_args(Stop)} are "
            f"needed, not {iterations}, {tolerance} and {stop!r}"
        )
    variance = np.diagonal(model.measurement_noise)
    independent = bool((np.diag(variance) == model.measurement_noise).all() and variance.all())
    return _UpdateSettings(iterations, tolerance, stop, independent and compiled.available())


def _predict(model: Model, state: Array, covariance: Array, k: int) -> tuple[Array, Array]:
    predicted, transition = jacobian.process(model, state, covariance, k)
    propagated = transition @ covariance @ np.swapaxes(transition, -2, -1)
    return predicted, _symmetric(propagated) + model.process_noise


def _update(
    model: Model, settings: _UpdateSettings, keeper: Gatekeeper | None, prior: _Prior
) -> tuple[Array, Array, Data]:
    """Posterior state and covariance, and what is counted."""
    measured = prior.used
    innovation, response = _linearise(model, prior, prior.state)
    counts: Data = {}
    if keeper is not None:
        prior, counts["reopened"] = _gated(model, keeper, prior, innovation, response)
    step = _step(model, settings, prior, innovation, response)
    state, counts["updates"] = _iterate(model, settings, prior, step)
    counts |= {"nis": step.nis, "nis_dof": prior.used.sum(-1)}
    counts["rejected"] = (measured & ~prior.used).sum(-1)
    return state, _posterior(model, settings, prior, step), counts


def _linearise(model: Model, prior: _Prior, state: Array) -> tuple[Array, Array]:
    """Innovation (run, m) and transposed Jacobian (run, n_e, m) at `state`."""
    shown, h = jacobian.measurement(model, state, prior.covariance, prior.k)
    return model.innovation(prior.y, shown), np.swapaxes(h, -2, -1)


def _gated(
    model: Model, keeper: Gatekeeper, prior: _Prior, innovation: Array, response: Array
) -> tuple[_Prior, IntArray]:
    noise = model.measurement_noise
    total = np.swapaxes(response, -2, -1) @ prior.covariance @ response + noise
    verdict = keeper.judge(prior.used, innovation, total, noise)
    covariance = keeper.doubted(prior.covariance, verdict.factor)
    prior = prior._replace(covariance=covariance, used=verdict.accepted)
    return prior, verdict.reopened.astype(np.int64)


def _step(
    model: Model, settings: _UpdateSettings, prior: _Prior, nu: Array, response: Array
) -> _Step:
    """Step by innovation and transposed Jacobian, without the components that are not used."""
    used, covariance = prior.used, prior.covariance
    if settings.loops:
        return _compiled_step(model, settings, prior, nu, response)
    h_t, noise = np.copy(response), model.measurement_noise
    if not used.all():
        nu, h_t, noise = drop_missing(used, nu, h_t, noise)
    cross = covariance @ h_t
    total = np.swapaxes(h_t, -2, -1) @ cross + noise
    right = np.concatenate([np.swapaxes(cross, -2, -1), nu[..., None]], axis=-1)
    solved = solve(total, right)
    gain = solved[..., :-1]
    variance = np.diagonal(covariance, 0, -2, -1)
    left = variance - (np.swapaxes(cross, -2, -1) * gain).sum(-2)
    return _Step(
        parts=(h_t, gain),
        correction=(nu[:, None] @ gain)[:, 0],
        variance=np.maximum(left, _SMALLEST_RATIO * variance),
        nis=(nu * solved[..., -1]).sum(-1),
    )


def _compiled_step(
    model: Model, settings: _UpdateSettings, prior: _Prior, nu: Array, response: Array
) -> _Step:
    from debrisest.filters.kalman.gauss_newton_loops import posterior, whitened_step

    sigma = np.sqrt(np.diagonal(model.measurement_noise))
    h = np.ascontiguousarray(np.swapaxes(response, -2, -1))
    correction, nis, root, factor = whitened_step(prior.covariance, h, sigma, prior.used, nu)
    variance = np.zeros_like(correction)
    if settings.stop == "scaled" and settings.iterations > 1:
        variance[:] = np.diagonal(posterior(root.copy(), factor), 0, -2, -1)
    return _Step((root, factor), correction, variance, nis)


def _iterate(
    model: Model, settings: _UpdateSettings, prior: _Prior, step: _Step
) -> tuple[Array, IntArray]:
    """Posterior state and number of steps; leaves the last step of every run in `step`."""

    def again(runs: IntArray) -> None:
        part, here = model.of(runs), prior.of(runs)
        at = part.retract(here.state, step.correction[runs])
        innovation, response = _linearise(part, here, at)
        lag = part.difference(here.state, at)
        residual = innovation - (lag[:, None] @ response)[:, 0]
        put(step, runs, _step(part, settings, here, residual, response))

    def moved(before: Array) -> BoolArray:
        """Whether a step was not short; a run that is not finite ends there."""
        old, new = (model.retract(prior.state, e) for e in (before, step.correction))
        if settings.stop == "relative_norm":
            change, size = np.linalg.norm(new - old, axis=-1), np.linalg.norm(new, axis=-1)
            return np.asarray(change > settings.tolerance * size)
        change = np.abs(model.difference(new, old))
        return np.asarray((change > settings.tolerance * np.sqrt(step.variance)).any(-1))

    count = iterate(step.correction, again, moved, settings.iterations)
    return model.retract(prior.state, step.correction), count


def _posterior(model: Model, settings: _UpdateSettings, prior: _Prior, step: _Step) -> Array:
    """(I - K H) P (I - K H)^T + K R K^T; the gain of a component not used is zero."""
    if settings.loops:
        from debrisest.filters.kalman.gauss_newton_loops import posterior

        return posterior(*step.parts)
    response, gain = step.parts
    kept = np.eye(response.shape[-2]) - response @ gain
    spread = np.swapaxes(kept, -2, -1) @ prior.covariance @ kept
    return _symmetric(spread + np.swapaxes(gain, -2, -1) @ (model.measurement_noise @ gain))


def _symmetric(a: Array) -> Array:
    return 0.5 * (a + np.swapaxes(a, -2, -1))
