"""Unscented Kalman filter, batched over runs."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.filters.estimates import Estimates, EstimatesWriter
from debrisest.filters.kalman.unscented_root import PairRule, unscented_root
from debrisest.filters.linear_algebra import solve, square_root
from debrisest.filters.missing import drop_missing
from debrisest.filters.model import Model, add, subtract


class UnscentedParameters(NamedTuple):
    """Spread of the sigma points in the standard scaled form; the paper's alpha is their product.

    Points lie at sqrt(alpha^2 (n_e + kappa)) sigma; beta = 2 suits a Gaussian.
    """

    alpha: float = 1.0
    beta: float = 2.0
    kappa: float = 0.0


_SPREAD = UnscentedParameters()


class _SigmaPointRule(NamedTuple):
    retract: Callable[[Array, Array], Array]
    scale: float
    mean_weights: Array
    covariance_weights: Array
    noise_root: Array


class _Prediction(NamedTuple):
    mean: Array
    points: Array
    deviations: Array
    added_noise: Array
    repairs: IntArray


def unscented(
    model: Model,
    state: Array,
    covariance: Array,
    measurements: Array,
    spread: UnscentedParameters = _SPREAD,
    keep: Sequence[int] = (),
    redraw: bool = True,
) -> Estimates:
    """Filter a batch of runs (Biondi et al. 2017, Eqs 32-42).

    `state` (run, n) and `covariance` (run, n_e, n_e) are the prior of epoch 0, which measurement 0
    updates; `measurements` (run, time, m), NaN = not observed; `keep` lists the epochs whose full
    covariance is wanted. Differences from the printed equations:

    * Eq 32: its alpha is alpha^2 (n_e + kappa) here.
    * Eqs 34-35: mean and covariance are those of the predicted points, X- instead of X^.
    * Eq 36: new points are drawn from the predicted covariance, Q included, so that on a linear
      model the filter is the Kalman filter whatever Q. Without `redraw` the predicted points are
      measured as they are, as printed, and S and C lack Q.
    * Eq 42: P- - K S K^T is evaluated as (dX - K dY) W (dX - K dY)^T + K R K^T + Q, equal but
      symmetric, and positive when the weights are.

    Points are drawn by addition unless the model has its own `difference`, in which case its
    `retract` draws them; the corrected state is always `retract(x, K nu)`. Where a
    model has steps for pairs of points, `unscented_root` does the same.
    """
    rule = _rule(model, covariance.shape[-1], spread)
    pairs = PairRule(rule.scale, spread.beta - spread.alpha**2)
    if redraw and model.paired and pairs.positive(covariance.shape[-1]):
        return unscented_root(model, model.paired, pairs, state, covariance, measurements, keep)
    epochs = measurements.shape[1]
    names = model.error_names
    writer = EstimatesWriter(names, state, covariance, epochs, keep, totals=["repairs"])
    going = writer.runs
    with np.errstate(all="ignore"):
        for k in range(epochs):
            if len(going) < len(state):
                model, state, covariance = model.of(going), state[going], covariance[going]
                measurements = measurements[going]
            if len(going) == 0:
                break
            predicted = _predict(model, rule, state, covariance, k, redraw)
            state, covariance, nis, dof = _update(model, rule, predicted, measurements[:, k], k)
            figures = {"nis": nis, "nis_dof": dof, "repairs": predicted.repairs}
            going = writer.record(k, state, covariance, figures)
    return writer.estimates()


def _rule(model: Model, n_e: int, spread: UnscentedParameters) -> _SigmaPointRule:
    """How points are drawn and weighed.

    A mean is taken of differences from the central point, so that point's weight plays no part.
    """
    scaled = spread.alpha**2 * (n_e + spread.kappa)
    if not scaled > 0.0:
        raise ValueError(
            f"alpha^2 (n_e + kappa) must be positive, not {scaled}, for n_e = {n_e} errors"
        )
    outer = np.full(2 * n_e + 1, 0.5 / scaled)
    central = 1.0 - n_e / scaled + 1.0 - spread.alpha**2 + spread.beta
    values, vectors = np.linalg.eigh(model.measurement_noise)
    return _SigmaPointRule(
        retract=add if model.difference is subtract else model.retract,
        scale=float(np.sqrt(scaled)),
        mean_weights=outer,
        covariance_weights=np.concatenate([[central], outer[1:]]),
        noise_root=np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T,
    )


def _predict(
    model: Model, rule: _SigmaPointRule, state: Array, covariance: Array, k: int, redraw: bool
) -> _Prediction:
    """Sigma points at epoch k before its measurement; at epoch 0 those of the prior itself."""
    start = _draw(rule, state, covariance)
    if k == 0:
        return start
    points = model.process(start.points, k - 1)
    centre = points[:, 0]
    mean = rule.retract(centre, rule.mean_weights @ model.difference(points, centre[:, None]))
    deviations = model.difference(points, mean[:, None])
    if not redraw:
        return _Prediction(mean, points, deviations, model.process_noise, start.repairs)
    again = _draw(rule, mean, _second_moment(rule, deviations) + model.process_noise)
    return again._replace(repairs=start.repairs + again.repairs)


def _draw(rule: _SigmaPointRule, mean: Array, covariance: Array) -> _Prediction:
    root, repaired = square_root(covariance)
    runs, n_e = covariance.shape[:2]
    errors = np.zeros((runs, 2 * n_e + 1, n_e))
    np.multiply(rule.scale, np.swapaxes(root, -2, -1), out=errors[:, 1 : n_e + 1])
    np.negative(errors[:, 1 : n_e + 1], out=errors[:, n_e + 1 :])
    points = rule.retract(mean[:, None], errors)
    return _Prediction(mean, points, errors, np.zeros((n_e, n_e)), repaired.astype(np.int64))


def _update(
    model: Model, rule: _SigmaPointRule, predicted: _Prediction, y: Array, k: int
) -> tuple[Array, Array, Array, IntArray]:
    """Posterior state and covariance, NIS, and the number of measured components."""
    shown = model.measurement(predicted.points, k)
    expected = shown[:, 0] + rule.mean_weights @ (shown - shown[:, :1])
    response = shown - expected[:, None]
    innovation = model.innovation(y, expected)
    noise = model.measurement_noise
    measured = ~np.isnan(y)
    if not measured.all():
        innovation, response, noise = drop_missing(measured, innovation, response, noise)
    if compiled.available():
        by_loops = _corrected(rule, predicted, response, innovation, noise)
        correction, covariance, nis = by_loops
        covariance += predicted.added_noise
        return model.retract(predicted.mean, correction), covariance, nis, measured.sum(-1)
    weighted = np.swapaxes(rule.covariance_weights[:, None] * response, -2, -1)
    cross = weighted @ predicted.deviations
    solved = solve(
        weighted @ response + noise, np.concatenate([cross, innovation[..., None]], axis=-1)
    )
    gain = solved[..., :-1]
    correction = (innovation[:, None] @ gain)[:, 0]
    residual = predicted.deviations - response @ gain
    covariance = (
        _second_moment(rule, residual) + _gram(rule.noise_root @ gain) + predicted.added_noise
    )
    nis = (innovation * solved[..., -1]).sum(-1)
    return model.retract(predicted.mean, correction), covariance, nis, measured.sum(-1)


def _corrected(
    rule: _SigmaPointRule, predicted: _Prediction, response: Array, innovation: Array, noise: Array
) -> tuple[Array, Array, Array]:
    from debrisest.filters.kalman.sigma_point_loops import corrected

    noises = np.broadcast_to(noise, (len(innovation), *noise.shape[-2:]))
    given = predicted.deviations, response, innovation, noises, rule.noise_root
    weights = float(rule.covariance_weights[0]), float(rule.covariance_weights[1])
    return corrected(weights, *(np.ascontiguousarray(each) for each in given))


def _second_moment(rule: _SigmaPointRule, deviations: Array) -> Array:
    """D^T W D of deviations D (run, point, n_e), symmetric to the last bit."""
    central, outer = rule.covariance_weights[0], rule.covariance_weights[1]
    moment: Array = outer * _gram(deviations) + (central - outer) * _gram(deviations[:, :1])
    return moment


def _gram(a: Array) -> Array:
    return np.swapaxes(a, -2, -1) @ a
