"""Jacobians of a model in its error coordinates: its own, or central differences."""

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.model import Model, add, subtract

_STEP_EXPONENT = -11
_LARGEST_SIGMA = 1.0


def process(model: Model, state: Array, covariance: Array, k: int) -> tuple[Array, Array]:
    """State at epoch k+1 (run, n), and its error per error of `state` (run, n_e, n_e)."""
    if model.process_jacobian is not None:
        given = model.process_jacobian(state, k)
        return model.process(state[:, None], k)[:, 0], np.broadcast_to(given, covariance.shape)
    step = _steps(covariance)
    points = model.process(_around(model, state, step), k)
    centre = points[:, :1]
    return centre[:, 0], _central(model.difference(points[:, 1:], centre), step)


def measurement(model: Model, state: Array, covariance: Array, k: int) -> tuple[Array, Array]:
    """What epoch k shows (run, m), and its change per error of `state` (run, m, n_e).

    Deviations are taken by the model's `innovation`, so that an angle may wrap between them.
    """
    if model.measurement_jacobian is not None:
        shown = model.measurement(state[:, None], k)[:, 0]
        given = model.measurement_jacobian(state, k)
        return shown, np.broadcast_to(given, (*shown.shape, covariance.shape[-1]))
    step = _steps(covariance)
    points = model.measurement(_around(model, state, step), k)
    centre = points[:, :1]
    return centre[:, 0], _central(model.innovation(points[:, 1:], centre), step)


def _steps(covariance: Array) -> Array:
    """Steps (run, n_e): powers of two between 2^-11 and 2^-10 sigma, sigma taken as at most 1.

    An update sees a column of a Jacobian only times its sigma. With steps in sigma, the rounding
    error of that product is 1e-13 of the function whatever the units, and its truncation 1e-7 of
    what the third derivative does within one sigma. Powers of two are added to most states without
    rounding, so that the row of a constant is exactly one.
    """
    sigma = np.sqrt(np.maximum(np.diagonal(covariance, 0, -2, -1), 0.0))
    _, exponent = np.frexp(np.minimum(sigma, _LARGEST_SIGMA))
    return np.asarray(np.ldexp(1.0, exponent + _STEP_EXPONENT), dtype=np.float64)


def _around(model: Model, state: Array, step: Array) -> Array:
    """The state itself, then each of its errors one step up, then each one down.

    As the sigma points, these are drawn by addition unless the model has its own `difference`.
    """
    runs, n_e = step.shape
    errors = np.zeros((runs, 2, n_e, n_e))
    diagonal = np.arange(n_e)
    errors[:, 0, diagonal, diagonal] = step
    errors[:, 1, diagonal, diagonal] = -step
    retract = add if model.difference is subtract else model.retract
    moved = retract(state[:, None], errors.reshape(runs, 2 * n_e, n_e))
    return np.concatenate([state[:, None], moved], axis=1)


def _central(deviations: Array, step: Array) -> Array:
    up, down = np.split(deviations, 2, axis=1)
    return np.asarray(np.swapaxes((up - down) / (2.0 * step[..., None]), -2, -1))
