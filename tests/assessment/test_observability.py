"""Unobservable directions of a covariance whose principal sigmas are known."""

import numpy as np
import pytest

from debrisest.assessment.observability import known_directions


def test_directions_are_counted_in_any_axes() -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(0).standard_normal((5, 5)))
    sigmas = np.array([1e-4, 0.5, 2e-3, 0.5, 0.4])
    unknown, worst = known_directions(turn @ np.diag(sigmas**2) @ turn.T, 0.5)
    assert unknown == 3
    assert worst == pytest.approx(2e-3)


@pytest.mark.parametrize("prior", [0.02, 0.5, 3.0])
def test_nothing_was_learned_of_what_is_known_as_before(prior: float) -> None:
    left = prior * np.array([1.0, 0.9, 0.51, 0.49, 0.01])
    unknown, worst = known_directions(np.diag(left**2), prior)
    assert unknown == 3
    assert worst == pytest.approx(0.49 * prior)


def test_all_and_none_and_a_lost_run() -> None:
    covariance = np.stack([1e-6 * np.eye(5), np.eye(5), np.full((5, 5), np.nan)])
    unknown, worst = known_directions(covariance, 0.5)
    assert unknown.tolist() == [0, 5, 5]
    assert worst[0] == pytest.approx(1e-3)
    assert np.isnan(worst[1:]).all()
