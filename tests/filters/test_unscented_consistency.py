"""Normalised errors of a Monte Carlo campaign are chi-square; those of a mis-tuned filter not."""

import numpy as np
import pytest

from debrisest.filters.kalman.unscented import unscented
from debrisest.filters.model import Model
from tests.filters.chi_square import assert_consistent, assert_inconsistent, nees, probable

RUNS, EPOCHS = 300, 40
F = np.array([[1.0, 1.0], [0.0, 1.0]])
H = np.array([[1.0, 0.0], [1.0, 0.5]])
Q = np.array([[0.02, 0.01], [0.01, 0.03]])
R = np.diag([0.5, 0.8])
P0 = np.diag([4.0, 1.0])


def campaign(seed):
    """Truth and measurements, a fifth of them missing."""
    rng = np.random.default_rng(seed)
    truth = np.empty((RUNS, EPOCHS, 2))
    truth[:, 0] = rng.multivariate_normal([0, 0], P0, size=RUNS)
    for k in range(1, EPOCHS):
        truth[:, k] = truth[:, k - 1] @ F.T + rng.multivariate_normal([0, 0], Q, size=RUNS)
    y = truth @ H.T + rng.normal(size=truth.shape) * np.sqrt(np.diagonal(R))
    y[rng.random(y.shape) < 0.2] = np.nan
    return truth, y


def filtered(y, q=Q, r=R, p0=P0):
    model = Model(lambda x, _: x @ F.T, lambda x, _: x @ H.T, q, r, ("position", "velocity"))
    start, covariance = np.zeros((RUNS, 2)), np.stack([p0] * RUNS)
    return unscented(model, start, covariance, y, keep=range(EPOCHS), redraw=True)


@pytest.mark.parametrize("seed", [0, 1])
def test_matched_filter_is_consistent(seed):
    truth, y = campaign(seed)
    history = filtered(y)
    assert_consistent(history, truth, (0, 10, EPOCHS - 1))


@pytest.mark.parametrize("change", [{"r": R / 4}, {"r": 4 * R}, {"q": Q / 20}])
def test_mistuned_filter_is_not(change):
    truth, y = campaign(0)
    history = filtered(y, **change)
    assert_inconsistent(history, truth, EPOCHS - 1)


def test_overconfident_start_is_found_at_once():
    truth, y = campaign(0)
    assert not probable(nees(filtered(y, p0=P0 / 9), truth, 0), 2 * RUNS)
