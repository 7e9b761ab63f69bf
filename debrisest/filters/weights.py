"""Weights that keep outliers out. They multiply normalised residuals."""

import numpy as np

from debrisest.arrays import Array

CAUCHY_SCALE = 3.0
GATE = 5.0
"""Innovations beyond this many sigma are rejected."""
LIMIT = 4.5
"""Residuals of the estimate itself beyond this are."""
FALSE_MATCH = 7.0
"""What is so far from the truth is an outlier, which an efficient estimator recognises: Gaussian
noise would be once in 10^11 times."""


def cauchy(residual: Array) -> Array:
    """Weights of Cauchy's loss, which lets go of outliers gradually."""
    return cauchy_weight((residual / CAUCHY_SCALE) ** 2)


def cauchy_weight(square: Array) -> Array:
    """The same by squares over `CAUCHY_SCALE`^2, for instance of a group that is judged as one."""
    return np.asarray((1.0 + square) ** -0.5)


def cauchy_loss(square: Array) -> Array:
    """Cauchy's loss of such squares."""
    return np.asarray(CAUCHY_SCALE**2 * np.log1p(square))


def hard(residual: Array) -> Array:
    """One for residuals within `LIMIT`, zero beyond."""
    return (np.abs(residual) < LIMIT).astype(np.float64)


def innovation_gate(innovation: Array, derivative: Array, covariance: Array) -> Array:
    """Weights ``(..., m)`` of normalised innovations, each row judged by itself, without a solver.

    `derivative` (..., m, n_e) is that of normalised rows, `covariance` (..., n_e, n_e) that of
    the prediction.
    """
    spread = 1.0 + ((derivative @ covariance) * derivative).sum(-1)
    return np.asarray(innovation**2 <= GATE**2 * spread, dtype=np.float64)
