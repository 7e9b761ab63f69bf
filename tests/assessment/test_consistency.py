"""NEES and NIS of draws whose covariance is known."""

import numpy as np
import pytest
from scipy.stats import chi2

from debrisest.assessment.consistency import chart_free, interval, normalized_square, verdict


def draws(seed, runs=3000, scale=1.0):
    rng = np.random.default_rng(seed)
    root = np.diag(10.0 ** rng.uniform(-6, 2, 5)) @ rng.normal(size=(5, 5))
    error = scale * rng.normal(size=(runs, 5)) @ root.T
    return error, np.broadcast_to(root @ root.T, (runs, 5, 5))


def test_squares_follow_the_chi_square_distribution():
    squares = normalized_square(*draws(0))
    for share in (0.1, 0.5, 0.9):
        assert np.mean(squares < chi2.ppf(share, 5)) == pytest.approx(share, abs=0.03)


@pytest.mark.parametrize(
    ("scale", "word"), [(1.0, "consistent"), (1.3, "over-confident"), (0.8, "over-cautious")]
)
def test_verdicts(scale, word):
    judged = verdict(normalized_square(*draws(1, scale=scale)), 5, 0.9999)
    assert judged.words.startswith(word)
    assert judged.mean == pytest.approx(scale**2, rel=0.07)
    assert judged.low < 1 < judged.high


def test_the_interval_covers_what_it_promises():
    rng = np.random.default_rng(2)
    low, high = interval(np.array(30))
    means = rng.chisquare(3, size=(20000, 10)).mean(-1) / 3
    assert np.mean((means > low) & (means < high)) == pytest.approx(0.95, abs=0.01)


def test_what_is_missing_does_not_count():
    error, covariance = draws(3, runs=6)
    error[2, 1] = np.nan
    spoilt = covariance.copy()
    spoilt[4, 0, 0] = np.nan
    squares = normalized_square(error, spoilt)
    np.testing.assert_array_equal(np.isnan(squares), [0, 0, 1, 0, 1, 0])
    assert verdict(squares, 5).mean == pytest.approx(np.nanmean(squares) / 5)
    assert verdict(np.full(3, np.nan), 5).words.startswith("unknown")
    counts = np.array([5, 0, 5, 5, 5, 5])
    assert verdict(squares, counts).mean == pytest.approx(np.nansum(squares[[0, 3, 5]]) / 15)


def test_chart_free_statistic_of_a_linear_estimate():
    """For Gaussian errors C(truth) - C(estimate) is the normalised square of the error."""
    error, covariance = draws(4)
    squares = normalized_square(error, covariance)
    assert chart_free(squares + 7.0, np.full(len(error), 7.0), 5).mean() == pytest.approx(
        1, abs=0.05
    )
