"""Differences of a statistic over runs, paired and unpaired, against closed forms."""

import numpy as np
import pytest
from scipy.stats import ttest_ind, ttest_rel

from debrisest.assessment.paired import difference

RUNS = 200


@pytest.fixture
def figures() -> tuple[np.ndarray, np.ndarray]:
    """Figures of runs whose common part is ten times larger than what tells them apart."""
    rng = np.random.default_rng(3)
    common = 5.0 + rng.standard_normal(RUNS)
    return common, common + 0.2 + 0.1 * rng.standard_normal(RUNS)


def test_paired_and_unpaired_widths_are_those_of_the_normal_law(figures) -> None:
    one, two = figures
    paired = difference("rmse", [one], [two], True, 1)
    apart = difference("rmse", [one], [two], False, 1)
    of_pairs = 2 * 1.96 * np.std(two - one) / np.sqrt(RUNS)
    of_both = 2 * 1.96 * np.hypot(np.std(one), np.std(two)) / np.sqrt(RUNS)
    assert paired.width == pytest.approx(of_pairs, rel=0.1)
    assert apart.width == pytest.approx(of_both, rel=0.1)
    assert paired.second - paired.first == pytest.approx(np.mean(two - one))
    assert paired.low < 0.2 < paired.high


def test_runs_that_are_paired_wrongly_gain_nothing(figures) -> None:
    one, two = figures
    shuffled = np.random.default_rng(4).permutation(two)
    apart = difference("rmse", [one], [two], False, 1)
    assert difference("rmse", [one], [shuffled], True, 1).width > 0.7 * apart.width


@pytest.mark.parametrize("name", ["rmse", "rms"])
@pytest.mark.parametrize("runs", [6, 30])
@pytest.mark.parametrize("paired", [True, False])
def test_intervals_hold_the_true_difference(name: str, runs: int, paired: bool) -> None:
    """Of 1000 samples of gamma errors 950, up to four standard errors of that and some skewness."""
    rng = np.random.default_rng(5)
    held = 0
    shift = {"rmse": 1.0, "rms": np.sqrt(4**2 + 4 + 2 * 4 + 1 + 0.25) - np.sqrt(4**2 + 4)}[name]
    for sample in range(1000):
        common = rng.gamma(4.0, size=(2, runs))
        one, two = common[0], common[0 if paired else 1] + 1.0 + 0.5 * rng.standard_normal(runs)
        found = difference(name, [one], [two], paired, sample)
        held += found.low < shift < found.high
    assert 0.915 <= held / 1000 <= 0.98


def test_the_interval_of_means_is_that_of_scipy(figures) -> None:
    one, two = (part[:9] for part in figures)
    found = difference("rmse", [one], [two], True, 1)
    expected = ttest_rel(two, one).confidence_interval()
    np.testing.assert_allclose([found.low, found.high], [expected.low, expected.high])
    found = difference("rmse", [one], [two[:6]], False, 1)
    expected = ttest_ind(two[:6], one, equal_var=False).confidence_interval()
    np.testing.assert_allclose([found.low, found.high], [expected.low, expected.high])


def test_percentiles_of_pairs_are_closer_than_each(figures) -> None:
    one, two = figures
    paired, apart = (difference("p50", [one], [two], both, 1) for both in (True, False))
    assert paired.low < np.median(two) - np.median(one) < paired.high
    assert paired.width < apart.width / 3


def test_groups_count_alike(figures) -> None:
    one, two = figures
    found = difference("rmse", [one, one[:50]], [two, two[:50] + 1.0], True, 1)
    expected = (np.mean(two - one) + np.mean(two[:50] - one[:50]) + 1.0) / 2
    assert found.second - found.first == pytest.approx(expected)
    assert found.low < expected < found.high


def test_a_group_without_runs_has_no_difference(figures) -> None:
    found = difference("rmse", [figures[0], np.zeros(0)], [figures[1], np.zeros(0)], True, 1)
    assert np.isnan(found).all()
    assert np.isnan(difference("rmse", [], [], True, 1)).all()
