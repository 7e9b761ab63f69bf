"""Differences of a statistic over runs, paired and unpaired, against closed forms."""

import numpy as np
import pytest

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


def test_intervals_of_pairs_hold_the_true_difference() -> None:
    """Of 300 samples of 30 pairs, from 90 % on: the bootstrap is a little too narrow."""
    rng = np.random.default_rng(5)
    held = 0
    for sample in range(300):
        common = rng.standard_normal(30)
        one, two = common, common + 1.0 + 0.5 * rng.standard_normal(30)
        found = difference("rmse", [one], [two], True, sample)
        held += found.low < 1.0 < found.high
    assert 0.90 <= held / 300 <= 0.98


def test_groups_count_alike_and_are_resampled_apart(figures) -> None:
    one, two = figures
    found = difference("rmse", [one, one[:50]], [two, two[:50] + 1.0], True, 1)
    expected = (np.mean(two - one) + np.mean(two[:50] - one[:50]) + 1.0) / 2
    assert found.second - found.first == pytest.approx(expected)
    assert found.low < expected < found.high


def test_a_group_without_runs_has_no_difference(figures) -> None:
    found = difference("rmse", [figures[0], np.zeros(0)], [figures[1], np.zeros(0)], True, 1)
    assert np.isnan(found).all()
    assert np.isnan(difference("rmse", [], [], True, 1)).all()
