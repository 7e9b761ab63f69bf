"""Normalised errors of a Monte Carlo campaign are chi-square; those of a mis-tuned filter not."""

import numpy as np
import pytest

from debrisest.filters.gate import Gate
from debrisest.filters.kalman.extended import extended
from debrisest.filters.model import Model
from tests.filters.chi_square import assert_consistent, assert_inconsistent, nees, probable

RUNS, EPOCHS = 300, 40
F = np.eye(4) + np.eye(4, k=2)
Q = np.diag([0.02, 0.02, 0.01, 0.01])
R = np.diag([0.25, 0.25, 0.005**2])
P0 = np.diag([1.0, 1.0, 0.04, 0.04])
START = np.array([100.0, 50.0, -1.0, 0.5])
PAIR = np.array([[0.0, 0.0], [80.0, -40.0]])


def seen(x, _):
    """Distances from two places, and a bearing: nearly linear within one sigma."""
    ray = x[..., None, :2] - PAIR
    bearing = np.arctan2(ray[..., 0, 1], ray[..., 0, 0])[..., None]
    return np.concatenate([np.linalg.norm(ray, axis=-1), bearing], axis=-1)


def campaign(seed):
    """Truth and measurements, a fifth of them missing."""
    rng = np.random.default_rng(seed)
    truth = np.empty((RUNS, EPOCHS, 4))
    truth[:, 0] = rng.multivariate_normal(START, P0, size=RUNS)
    for k in range(1, EPOCHS):
        noise = rng.multivariate_normal(np.zeros(4), Q, size=RUNS)
        truth[:, k] = truth[:, k - 1] @ F.T + noise
    y = seen(truth, 0)
    y = y + rng.normal(size=y.shape) * np.sqrt(np.diagonal(R))
    y[rng.random(y.shape) < 0.2] = np.nan
    return truth, y


def filtered(y, q=Q, r=R, p0=P0, **rule):
    model = Model(lambda x, _: x @ F.T, seen, q, r, ("x", "y", "v_x", "v_y"))
    start, covariance = np.stack([START] * RUNS), np.stack([p0] * RUNS)
    return extended(model, start, covariance, y, keep=range(EPOCHS), **rule)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("rule", [{}, {"iterations": 5}, {"gate": Gate()}])
def test_matched_filter_is_consistent(seed, rule):
    truth, y = campaign(seed)
    history = filtered(y, **rule)
    assert_consistent(history, truth, (0, 10, EPOCHS - 1))


@pytest.mark.parametrize("change", [{"r": R / 4}, {"r": 4 * R}, {"q": Q / 20}])
@pytest.mark.parametrize("iterations", [1, 5])
def test_mistuned_filter_is_not(change, iterations):
    truth, y = campaign(0)
    history = filtered(y, iterations=iterations, **change)
    assert_inconsistent(history, truth, EPOCHS - 1)


def test_overconfident_start_is_found_at_once():
    truth, y = campaign(0)
    assert not probable(nees(filtered(y, p0=P0 / 9), truth, 0), 4 * RUNS)
