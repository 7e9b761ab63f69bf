"""Intervals over runs: exact cases, what a sample cannot give, and coverage over error laws."""

import numpy as np
import pytest
from scipy import stats
from scipy.stats import binom

from debrisest.assessment.intervals import with_interval

RUNS = (5, 8, 20, 100)
TRIALS = 600
LAWS = {
    "halfnormal": stats.halfnorm(),
    "root mean square of three": stats.chi(3),
    "lognormal": stats.lognorm(0.5),
    "gamma": stats.gamma(4),
}


def covered(name: str, law: object, truth: float, runs: int, shrink: float = 1.0) -> int:
    """Return in how many of the trials the interval, shrunk about its figure, holds the truth."""
    samples = law.rvs(size=(TRIALS, runs), random_state=np.random.default_rng(runs))
    hits = 0
    for figures in samples:
        middle, low, high = with_interval(name, [figures])
        hits += middle + shrink * (low - middle) <= truth <= middle + shrink * (high - middle)
    return hits


def likely(hits: int, low: float, high: float) -> bool:
    """Whether a coverage between low and high explains the hits, but for one case in 1e5."""
    return bool(binom.sf(hits - 1, TRIALS, high) > 1e-5 and binom.cdf(hits, TRIALS, low) > 1e-5)


@pytest.mark.parametrize("runs", RUNS)
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_means_are_covered(law: object, runs: int) -> None:
    assert likely(covered("rmse", law, law.mean(), runs), 0.93, 0.97)


@pytest.mark.parametrize("runs", RUNS)
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_medians_are_covered(law: object, runs: int) -> None:
    assert likely(covered("median", law, law.median(), runs), 0.93, 0.97)


@pytest.mark.parametrize("runs", RUNS)
@pytest.mark.parametrize("law", [LAWS["halfnormal"], LAWS["root mean square of three"]])
def test_root_mean_squares_are_covered(law: object, runs: int) -> None:
    truth = np.sqrt(law.var() + law.mean() ** 2)
    samples = law.rvs(size=(TRIALS, runs), random_state=np.random.default_rng(runs))
    ends = np.array([with_interval("rms", [figures])[1:] for figures in samples])
    hits = int((~(ends[:, 0] > truth) & ~(ends[:, 1] < truth)).sum())
    assert likely(hits, 0.92, 0.97)


@pytest.mark.parametrize(("name", "share"), [("p70", 0.7), ("p90", 0.9)])
def test_percentiles_are_covered_where_the_sample_has_both_ends(name: str, share: float) -> None:
    law = LAWS["gamma"]
    assert likely(covered(name, law, law.ppf(share), 100), 0.93, 0.97)


@pytest.mark.parametrize("shrink", [0.6, 1.8])
@pytest.mark.parametrize("name", ["rmse", "median"])
def test_a_mistuned_interval_is_noticed(name: str, shrink: float) -> None:
    law = LAWS["gamma"]
    truth = law.mean() if name == "rmse" else law.median()
    assert not likely(covered(name, law, truth, 20, shrink), 0.93, 0.97)


def test_a_mean_with_both_signs_has_students_interval() -> None:
    figures = np.random.default_rng(2).normal(0.0, 3.0, 12)
    expected = stats.ttest_1samp(figures, 0.0).confidence_interval(0.95)
    assert with_interval("mean", [figures])[1:] == pytest.approx(tuple(expected))


def test_two_cases_of_unlike_spread_have_welchs_interval() -> None:
    rng = np.random.default_rng(3)
    one, other = rng.normal(0.0, 1.0, 5), rng.normal(0.0, 4.0, 30)
    difference = stats.ttest_ind(one, -other, equal_var=False).confidence_interval(0.95)
    ends = with_interval("mean", [one, other])[1:]
    assert [2 * end for end in ends] == pytest.approx(list(difference))


def test_a_share_of_runs_has_wilsons_interval() -> None:
    figures = np.array([1.0] * 3 + [0.0] * 17)
    expected = stats.binomtest(3, 20).proportion_ci(0.95, method="wilson")
    assert with_interval("share", [figures])[1:] == pytest.approx(tuple(expected))
    assert with_interval("ever", [np.zeros(20)])[1:] == pytest.approx((0.0, 0.1611), abs=1e-4)


@pytest.mark.parametrize("runs", [5, 20, 100, 300])
def test_the_interval_of_a_share_ends_where_shares_end(runs: int) -> None:
    assert with_interval("share", [np.zeros(runs)])[1] == 0
    assert with_interval("share", [np.ones(runs)])[2] == 1


def test_positive_figures_never_have_an_end_below_zero() -> None:
    assert with_interval("rmse", [np.array([0.1, 0.1, 4.0])])[1] > 0


def test_the_scale_does_not_matter() -> None:
    figures = np.random.default_rng(4).gamma(2.0, size=9)
    for name in ("rmse", "rms", "median", "p70"):
        small, large = (np.array(with_interval(name, [k * figures])) for k in (1e-3, 1e3))
        assert 1e6 * small == pytest.approx(large, nan_ok=True)


@pytest.mark.parametrize("runs", [1, 20, 100])
def test_a_largest_has_no_interval(runs: int) -> None:
    assert np.isnan(with_interval("p100", [np.random.default_rng(0).random(runs)])[1:]).all()


def test_an_end_beyond_the_sample_is_missing() -> None:
    """Twenty runs all lie below the ninetieth percentile in 12 % of samples: no upper end."""
    _, low, high = with_interval("p90", [np.random.default_rng(0).random(20)])
    assert np.isfinite(low)
    assert np.isnan(high)
    assert np.isnan(with_interval("median", [np.arange(3.0)])[1:]).all()


def test_medians_of_five_end_at_the_extremes() -> None:
    """All five lie on one side of the median in 6.25 % of samples."""
    assert with_interval("median", [np.arange(5.0)]) == (2.0, 0.0, 4.0)


@pytest.mark.parametrize("name", ["rmse", "rms", "mean", "median"])
def test_a_single_run_has_no_interval(name: str) -> None:
    middle, low, high = with_interval(name, [np.array([2.0])])
    assert middle == 2.0
    assert np.isnan([low, high]).all()


def test_runs_that_agree_leave_no_doubt() -> None:
    assert with_interval("rmse", [np.full(100, 1.0), np.full(2, 4.0)]) == (2.5, 2.5, 2.5)
    assert with_interval("rms", [np.zeros(4)]) == (0.0, 0.0, 0.0)


def test_cases_are_fixed_and_their_runs_a_sample() -> None:
    """Cases that differ widely, of runs that agree, leave little doubt about their mean."""
    rng = np.random.default_rng(1)
    figures = [centre + 0.01 * rng.standard_normal(20) for centre in (1.0, 50.0, 200.0)]
    middle, low, high = with_interval("rmse", figures)
    assert middle == pytest.approx(np.mean(figures))
    assert 2 < (high - low) / (0.01 / np.sqrt(60)) < 6
    _, pooled_low, pooled_high = with_interval("rmse", [np.concatenate(figures)])
    assert pooled_high - pooled_low > 1000 * (high - low)


@pytest.mark.parametrize("groups", [[], [np.array([])], [np.array([1.0]), np.array([])]])
def test_without_runs_there_is_no_figure(groups: list[np.ndarray]) -> None:
    assert np.isnan(with_interval("rmse", groups)).all()


def test_figures_that_are_not_finite_give_no_interval() -> None:
    assert np.isnan(with_interval("median", [np.array([1.0, np.inf, 2.0, 3.0, 4.0])])[1:]).all()
