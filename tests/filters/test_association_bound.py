"""The filter linearised at the truth against the Cramer-Rao bound of whole trajectories."""

import numpy as np
import pytest
from scipy.stats import chi2

from debrisest.filters.association.single import associated
from debrisest.filters.association.weights import Validation
from debrisest.filters.scan_model import ScanModel

RUNS, EPOCHS, SENSORS = 150, 12, 2
R = np.array([[0.02, 0.01], [0.01, 0.03]])
P0 = np.array([[0.04, 0.01], [0.01, 0.09]])
Q = np.array([[0.01, 0.002], [0.002, 0.02]])


def process(x, k):
    """A pendulum whose length changes."""
    angle, rate = x[..., 0], x[..., 1]
    return np.stack([angle + 0.2 * rate, rate - (0.2 + 0.02 * k) * np.sin(angle)], axis=-1)


def process_jacobian(x, k):
    slope = np.broadcast_to([[1.0, 0.2], [0.0, 1.0]], (*x.shape, 2)).copy()
    slope[..., 1, 0] = -(0.2 + 0.02 * k) * np.cos(x[..., 0])
    return slope


def points(x, _):
    angle, rate = x[..., 0], x[..., 1]
    first = np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    return np.stack([first, np.stack([rate, angle], axis=-1)], axis=-2)


def points_jacobian(x, _):
    h = np.zeros((*x.shape[:-1], SENSORS, 2, 2))
    h[..., 0, 0, 0], h[..., 0, 1, 0] = np.cos(x[..., 0]), -np.sin(x[..., 0])
    h[..., 1, 0, 1] = h[..., 1, 1, 0] = 1.0
    return h


MODEL = ScanModel(process, process_jacobian, Q, points, points_jacobian, R, ("angle", "rate"))


def campaign(seed):
    rng = np.random.default_rng(seed)
    truth = np.empty((RUNS, EPOCHS, 2))
    truth[:, 0] = [0.7, -0.3]
    for k in range(1, EPOCHS):
        pushed = rng.multivariate_normal(np.zeros(2), Q, size=RUNS)
        truth[:, k] = process(truth[:, k - 1], k - 1) + pushed
    shown = points(truth, 0)
    y = shown + rng.multivariate_normal(np.zeros(2), R, size=shown.shape[:3])
    detected = rng.random(shown.shape[:3]) < 0.6
    guess = truth[:, 0] + rng.multivariate_normal(np.zeros(2), P0, size=RUNS)
    return truth, np.where(detected[..., None], y, np.nan)[..., None, :], detected, guess


def whole_trajectory(truth, detected, last):
    """Covariance of the last state from the information of all states together."""
    size = 2 * (last + 1)
    information = np.zeros((size, size))
    information[:2, :2] = np.linalg.inv(P0)
    for k in range(last + 1):
        here = slice(2 * k, 2 * k + 2)
        for s in np.flatnonzero(detected[k]):
            h = points_jacobian(truth[k], k)[s]
            information[here, here] += h.T @ np.linalg.inv(R) @ h
        if k > 0:
            step = np.zeros((2, size))
            step[:, here] = np.eye(2)
            step[:, 2 * k - 2 : 2 * k] = -process_jacobian(truth[k - 1], k - 1)
            information += step.T @ np.linalg.inv(Q) @ step
    return np.linalg.inv(information)[-2:, -2:]


def efficient(model, guess, scans, truth):
    start = np.stack([P0] * RUNS)
    given = model, guess, start, scans, Validation()
    return associated(*given, method="known", truth=truth, keep=range(EPOCHS))


@pytest.mark.parametrize("seed", [0, 1])
def test_its_covariance_is_the_bound_of_the_whole_trajectory(seed):
    truth, scans, detected, guess = campaign(seed)
    found = efficient(MODEL, guess, scans, truth).covariance
    for run in range(3):
        for k in range(EPOCHS):
            expected = whole_trajectory(truth[run], detected[run], k)
            np.testing.assert_allclose(found[run, k], expected, rtol=1e-9)


@pytest.mark.parametrize("seed", [0, 1])
def test_its_errors_are_at_the_bound(seed):
    truth, scans, _, guess = campaign(seed)
    found = efficient(MODEL, guess, scans, truth)
    error = (found.state - truth)[:, :, None, :]
    inverse = np.linalg.inv(found.covariance)
    squared = (error @ inverse @ np.swapaxes(error, -1, -2)).sum((0, 2, 3))
    assert (squared > chi2.ppf(1e-8, 2 * RUNS)).all()
    assert (squared < chi2.isf(1e-8, 2 * RUNS)).all()


def test_a_derivative_is_not_looked_at_where_nothing_is_detected() -> None:
    truth, scans, detected, guess = campaign(0)
    blind = MODEL._replace(points_jacobian=lambda x, k: np.full_like(points_jacobian(x, k), np.nan))
    found = efficient(blind, guess, np.full_like(scans, np.nan), truth)
    expected = whole_trajectory(truth[0], 0 * detected[0], EPOCHS - 1)
    np.testing.assert_allclose(found.covariance[0, -1], expected, rtol=1e-9)
