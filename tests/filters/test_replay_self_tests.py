"""Self-tests of the replay filter: right models pass, wrong ones are told with their size."""

import numpy as np
import pytest

from debrisest.filters.replay.replay import replay
from debrisest.filters.replay.self_tests import _scores, self_tests
from debrisest.filters.replay_model import Doubt
from debrisest.filters.verdict import judged, told
from tests.filters.constants import constants

RUNS, EPOCHS, SIGMA = 200, 60, 0.5
DOUBT = Doubt("a slope of {size:.2f} ({value})", 10.0, lambda s, _, __, ___: _times(s)[..., None])


def _times(states):
    return np.broadcast_to(np.arange(states.shape[1]) / EPOCHS, states.shape[:2])


def line():
    """A constant that is measured directly; what grows with time is doubted."""

    rows = lambda states, sensitivity, first, epochs: (states, sensitivity)  # noqa: E731
    return constants(rows, np.array([SIGMA]), ("a",), doubts=(DOUBT,))


def fit_of(error=0.0, noise=1.0, seed=0):
    """Tests of runs whose measurements carry an error (time,), and noise of another size."""
    rng = np.random.default_rng(seed)
    truth = rng.normal(size=(RUNS, 1))
    prior, covariance = truth + rng.normal(size=(RUNS, 1)), np.ones((RUNS, 1, 1))
    drawn = noise * SIGMA * rng.normal(size=(RUNS, EPOCHS, 1))
    measured = truth[:, None] + drawn + np.broadcast_to(error, (EPOCHS,))[:, None]
    measured[0, 10:20] = np.nan
    prior[1] = np.nan
    known = line(), prior, covariance, measured
    found = replay(*known)
    return found, self_tests(*known, found)


def test_right_models_pass_and_the_doubted_number_is_a_unit_normal():
    found, tests = fit_of()
    code = judged(tests, RUNS).code
    assert code.sum() == 0
    score = tests[2].value[2:]
    assert np.mean(score**2) == pytest.approx(1.0, abs=5 * np.sqrt(2 / RUNS))
    assert told(found, tests).counts["doubt"][1] == 3, "a run without a start is lost"


def test_larger_noise_is_told_by_the_cost():
    _, tests = fit_of(noise=2.0)
    assert tests[0].failed[2:].mean() > 0.95


def test_what_is_doubted_is_told_with_its_size():
    _, tests = fit_of(error=2.0 * np.arange(EPOCHS) / EPOCHS)
    assert tests[2].failed[2:].mean() > 0.95
    assert np.mean(tests[2].size[2:]) == pytest.approx(20.0, abs=1.0)
    assert "a slope of " in judged(tests, RUNS).sentence[5]


def test_errors_that_last_are_told_by_blocks():
    """A square wave of a third of the noise: each epoch hides it."""
    slow = 0.6 * SIGMA * np.sign(np.sin(2 * np.pi * np.arange(EPOCHS) / 12 + 0.1))
    _, tests = fit_of(error=slow)
    assert tests[0].failed.sum() == 0
    assert tests[1].value[2:].mean() > 1.5


def test_a_number_that_is_hardly_apart_from_the_errors_is_not_rounding() -> None:
    """Against orthogonal columns; of sums of squares the difference would be off by an eighth."""
    draws = np.random.default_rng(5)
    rows, own = draws.normal(size=(400, 12)), 1e-3 * draws.normal(size=400)
    rows[:, 1] = rows[:, 0] + 1e-5 * rows[:, 1]
    mixed, left = draws.normal(size=12), draws.normal(size=400)
    mixed[:2] = 1e5, -1e5
    basis = np.linalg.qr(np.concatenate([rows, 1e-6 * np.eye(12)]))[0]
    apart = np.concatenate([own, -1e-6 * mixed])
    for _ in range(2):
        apart = apart - basis @ (basis.T @ apart)
    given = rows, left[:, None], 1e-12 * np.eye(12), np.zeros(12), (rows @ mixed + own)[:, None]
    value, sigma = _scores(*(each[None] for each in given))
    np.testing.assert_allclose(sigma[0, 0], np.linalg.norm(apart) ** -1.0, rtol=1e-6)
    np.testing.assert_allclose(value[0, 0], apart[:400] @ left / (apart @ apart), rtol=1e-6)
