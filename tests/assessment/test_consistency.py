"""NEES and NIS of draws whose covariance is known."""

import numpy as np
import pytest
from scipy.stats import chi2

from debrisest.assessment.consistency import (
    chart_free,
    consistent_interval,
    dof_of_runs,
    interval,
    normalized_square,
    pooled,
)


def draws(seed, runs=3000, scale=1.0):
    rng = np.random.default_rng(seed)
    root = np.diag(10.0 ** rng.uniform(-6, 2, 5)) @ rng.normal(size=(5, 5))
    error = scale * rng.normal(size=(runs, 5)) @ root.T
    return error, np.broadcast_to(root @ root.T, (runs, 5, 5))


def test_squares_follow_the_chi_square_distribution():
    squares = normalized_square(*draws(0))
    for share in (0.1, 0.5, 0.9):
        assert np.mean(squares < chi2.ppf(share, 5)) == pytest.approx(share, abs=0.03)


@pytest.mark.parametrize(("scale", "side"), [(1.0, 0), (1.3, 1), (0.8, -1)])
@pytest.mark.parametrize("statistic", ["mean", "median"])
def test_errors_of_the_wrong_size_lie_outside(scale, side, statistic):
    per_dimension = normalized_square(*draws(1, scale=scale)) / 5
    low, high = consistent_interval(statistic, [np.full(3000, 5.0)], 0.9999)
    figure = {"mean": np.mean, "median": np.median}[statistic](per_dimension)
    assert np.sign(int(figure > high) - int(figure < low)) == side


def test_the_interval_covers_what_it_promises():
    rng = np.random.default_rng(2)
    low, high = interval(np.array(30))
    means = rng.chisquare(3, size=(20000, 10)).mean(-1) / 3
    assert np.mean((means > low) & (means < high)) == pytest.approx(0.95, abs=0.01)


def test_a_singular_covariance_has_no_square_and_leaves_the_others():
    error, covariance = draws(3)
    spoilt = covariance.copy()
    spoilt[0] = np.ones_like(spoilt[0])
    squares = normalized_square(error, spoilt)
    assert np.isnan(squares[0])
    np.testing.assert_array_equal(squares[1:], normalized_square(error, covariance)[1:])


def test_what_is_missing_does_not_count():
    error, covariance = draws(3, runs=6)
    error[2, 1] = np.nan
    spoilt = covariance.copy()
    spoilt[4, 0, 0] = np.nan
    squares = normalized_square(error, spoilt)
    np.testing.assert_array_equal(np.isnan(squares), [0, 0, 1, 0, 1, 0])


def coverage(statistic, freedom, trials=4000, seed=5):
    """Share of trials in which a statistic of chi-squares lies in its interval."""
    squares = np.random.default_rng(seed).chisquare(freedom, (trials, len(freedom))) / freedom
    low, high = consistent_interval(statistic, [freedom])
    over_runs = {"mean": np.mean, "median": np.median, "p50": np.median}[statistic]
    figures = over_runs(squares, axis=-1)
    return np.mean((figures > low) & (figures < high))


@pytest.mark.parametrize("statistic", ["mean", "median", "p50"])
@pytest.mark.parametrize("runs", [1, 9, 20, 101])
def test_the_interval_of_a_statistic_covers_what_it_promises(statistic, runs):
    assert coverage(statistic, np.full(runs, 29.0)) == pytest.approx(0.95, abs=0.02)


@pytest.mark.parametrize("runs", [2, 4, 6])
@pytest.mark.parametrize("freedom", [3.0, 29.0])
def test_the_median_of_a_few_has_an_interval_neither_too_wide_nor_too_narrow(runs, freedom):
    """Taken for an odd number, 2 and 4 runs would be covered with 97 % and more."""
    covered = coverage("median", np.full(runs, freedom), trials=40000)
    assert 0.93 < covered < 0.96


def test_the_median_of_two_is_their_mean():
    for freedom in ([3.0, 3.0], [4.0, 9.0]):
        groups = [np.array(freedom)]
        wanted = consistent_interval("mean", groups)
        assert consistent_interval("median", groups) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("runs", [(20,) * 9, (1,) * 4, (2,) * 5, (5, 20, 60), (9, 10) * 5])
@pytest.mark.parametrize("statistic", ["median", "p50", "mean"])
def test_a_mean_over_cases_is_covered_as_promised(runs, statistic):
    rng, freedom = np.random.default_rng(8), 6 + 3 * np.arange(len(runs))
    squares = [rng.chisquare(f, (4000, n)) / f for f, n in zip(freedom, runs)]
    over_runs = np.mean if statistic == "mean" else np.median
    figures = np.mean([over_runs(square, axis=-1) for square in squares], axis=0)
    groups = [np.full(n, float(f)) for f, n in zip(freedom, runs)]
    low, high = consistent_interval(statistic, groups)
    assert np.mean((figures > low) & (figures < high)) == pytest.approx(0.95, abs=0.02)


@pytest.mark.parametrize("statistic", ["mean", "median"])
def test_runs_may_differ_in_their_freedom(statistic):
    freedom = np.random.default_rng(6).integers(20, 45, 40).astype(float)
    assert coverage(statistic, freedom) == pytest.approx(0.95, abs=0.02)


def test_a_mean_over_cases_has_a_narrower_interval():
    one = consistent_interval("mean", [np.full(10, 4.0)])
    assert consistent_interval("mean", [np.full(10, 4.0)] * 9) == consistent_interval(
        "mean", [np.full(90, 4.0)]
    )
    assert one[0] < consistent_interval("mean", [np.full(10, 4.0)] * 9)[0]


@pytest.mark.parametrize("statistic", ["p90", "p100", "rms", "share"])
def test_other_statistics_are_not_judged(statistic):
    assert np.isnan(consistent_interval(statistic, [np.full(10, 4.0)])).all()


@pytest.mark.parametrize("groups", [[], [np.zeros(0)], [np.array([4.0, 0.0])]])
def test_without_freedom_there_is_no_interval(groups):
    assert np.isnan(consistent_interval("mean", groups)).all()


def test_freedom_adds_up_over_independent_epochs_only():
    freedom = np.array([[4.0, 0.0, 4.0, 4.0], [0.0, 0.0, 7.0, 0.0], [0.0, 0.0, 0.0, 0.0]])
    assert dof_of_runs("mean", freedom, white=True) == pytest.approx([12, 7, 0])
    assert dof_of_runs("mean", freedom, white=False) == pytest.approx([4, 7, 0])
    assert dof_of_runs("median", freedom, white=True) == pytest.approx([0, 7, 0])
    assert pooled(np.array([3.0, 3.0])) == pytest.approx(6)


def test_a_span_of_one_repeated_error_is_not_taken_for_many():
    """Errors that stay what they are: the mean over 50 epochs is that of one."""
    squares = np.random.default_rng(7).chisquare(6, (4000, 10)).mean(-1) / 6
    for white, expected in ((False, 0.95), (True, 0.3)):
        runs = dof_of_runs("mean", np.full((10, 50), 6.0), white)
        low, high = consistent_interval("mean", [runs])
        share = np.mean((squares > low) & (squares < high))
        assert share == pytest.approx(expected, abs=0.02) if not white else share < expected


def test_chart_free_statistic_of_a_linear_estimate():
    """For Gaussian errors C(truth) - C(estimate) is the normalised square of the error."""
    error, covariance = draws(4)
    squares = normalized_square(error, covariance)
    assert chart_free(squares + 7.0, np.full(len(error), 7.0), 5).mean() == pytest.approx(
        1, abs=0.05
    )
