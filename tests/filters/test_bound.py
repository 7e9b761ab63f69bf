"""The efficient estimators against the Kalman filter and least squares, and their statistics."""

import numpy as np

from debrisest.assessment.consistency import interval, normalized_square
from debrisest.filters.bound.motion import efficient

F = np.array([[1.0, 0.4], [-0.2, 0.9]])
H = np.array([[1.0, 0.2], [0.0, 1.5]])
SIGMA = np.array([0.3, 2.0])
PRIOR = np.array([[2.0, 0.3], [0.3, 1.0]])
EPOCHS = 9


def experiment(runs, seed):
    rng = np.random.default_rng(seed)
    transition = np.array([np.linalg.matrix_power(F, k) for k in range(EPOCHS)])
    derivative = np.broadcast_to(H @ transition, (runs, EPOCHS, 2, 2))
    error = rng.normal(size=(runs, 2)) @ np.linalg.cholesky(PRIOR).T
    noise = SIGMA * rng.normal(size=(runs, EPOCHS, 2))
    noise[:, 0] = np.nan
    noise[:, 4, 1] = np.nan
    transition = np.broadcast_to(transition, (runs, EPOCHS, 2, 2))
    bound = efficient(transition, derivative, noise, SIGMA, error, PRIOR, range(EPOCHS))
    return error, noise, bound


def test_the_filter_bound_is_the_kalman_filter():
    error, noise, bound = experiment(3, 0)
    for run in range(3):
        e, p = error[run], PRIOR
        for k in range(EPOCHS):
            if k:
                e, p = F @ e, F @ p @ F.T
            seen = ~np.isnan(noise[run, k])
            h, r = H[seen], np.diag(SIGMA[seen] ** 2)
            gain = p @ h.T @ np.linalg.inv(h @ p @ h.T + r)
            e, p = e + gain @ (noise[run, k, seen] - h @ e), p - gain @ h @ p
            np.testing.assert_allclose(bound.filter_error[run, k], e, atol=1e-11)
            np.testing.assert_allclose(bound.filter_covariance[run, k], p, atol=1e-11)


def test_the_smoother_bound_agrees_at_the_end_and_is_better_before():
    _, _, bound = experiment(2, 1)
    for smoothed, filtered in zip(bound[3:], bound[:3]):
        np.testing.assert_allclose(smoothed[:, -1], filtered[:, -1], atol=1e-12)
    gain = np.linalg.eigvalsh(bound.filter_covariance[0] - bound.smoother_covariance[0])
    assert gain.min() > -1e-12


def test_the_bound_is_consistent():
    _, _, bound = experiment(2000, 2)
    for error, _, covariance in (bound[:3], bound[3:]):
        for k in (0, 3, EPOCHS - 1):
            squares = normalized_square(error[:, k], covariance[:, k])
            low, high = interval(np.array(2 * len(squares)), 0.9999)
            assert low < squares.mean() / 2 < high
