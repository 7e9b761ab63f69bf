"""Self-tests pass what is right as often as they should, and fail what is wrong."""

import numpy as np
import pytest

from debrisest.assessment.silent import silent_failures
from debrisest.filters.association.self_tests import missed_test
from debrisest.filters.estimates import Estimates
from debrisest.filters.self_test import (
    bend_test,
    block_test,
    cost_test,
    lost_test,
    parts_test,
    rival_test,
    score_test,
)
from debrisest.filters.verdict import SelfTest, Verdict, judged, told

RUNS = 2000


def test_right_costs_pass_and_larger_noise_is_told() -> None:
    dof = np.full(RUNS, 3000)
    cost = np.random.default_rng(0).chisquare(3000, RUNS)
    assert not cost_test(cost, dof).failed.any()
    assert cost_test(1.2 * cost, dof).failed.mean() > 0.95


def test_blocks_see_a_slow_error_below_the_noise() -> None:
    rng = np.random.default_rng(1)
    noise = rng.standard_normal((200, 20, 50, 2))
    sums = noise.sum(2) / np.sqrt(50.0)
    assert not block_test(sums, 0.0).failed.any()
    wave = 0.45 * np.sin(np.linspace(0.0, 9.0, 20))[:, None, None]
    slow = (noise + wave).sum(2) / np.sqrt(50.0)
    assert ((noise + wave) ** 2).mean() < 1.12
    assert block_test(slow, 0.0).failed.mean() > 0.95
    sums[:, 3] = np.nan
    assert not block_test(sums, 0.0).failed.any()


def test_a_part_agrees_with_the_whole_unless_one_of_them_is_wrong() -> None:
    rng = np.random.default_rng(2)
    half = [rng.standard_normal((RUNS, 3)) * [1.0, 2.0, 3.0] for _ in range(2)]
    spread = np.tile(np.diag([1.0, 4.0, 9.0]), (RUNS, 1, 1))
    both, both_spread = 0.5 * (half[0] + half[1]), 0.5 * spread
    test = parts_test(half[0], both, spread, 0.49 * spread)
    assert not parts_test(half[0], both, spread, 0.499 * spread).failed.any()
    np.testing.assert_allclose(test.value.mean(), 0.5 / 0.51, rtol=0.1)
    off = parts_test(half[0], both + np.array([0.0, 20.0, 0.0]), spread, 0.499 * spread)
    assert off.failed.mean() > 0.95
    alike = parts_test(half[0], both + 50.0, both_spread, both_spread)
    assert not alike.failed.any()  # the rest of the data tells nothing: nothing is tested


def test_the_worst_verdict_decides_and_gives_its_reasons() -> None:
    tests = [
        cost_test(np.array([1.0, 9.0, 9.0, 9.0]) * 1000, np.full(4, 1000)),
        missed_test(np.array([9, 0, 9, 9]), np.full(4, 10), 0.9),
        rival_test(np.array([np.inf, np.nan, 3.0, 3.0])),
        lost_test(np.array([False, False, False, True]), "nothing fits"),
        bend_test(np.full(4, np.nan)),
    ]
    found = judged(tests, 4)
    assert found.code.tolist() == [0, 1, 2, 3]
    assert found.sentence[0] == "consistent"
    assert found.sentence[1].startswith("errors may be larger than stated: the cost")
    assert "in a share of 1 of the views" in found.sentence[1]
    assert found.sentence[2].startswith("ambiguous: the motion and another one")
    assert found.sentence[3] == "lost: nothing fits"


def test_a_score_is_told_with_its_size() -> None:
    value, sigma = np.array([1e-3, 1e-2]), np.array([1e-3, 1e-3])
    found = judged([score_test(value, sigma, "off by {size:+.2g} deg ({value} sigma)", 57.3)], 2)
    assert found.code.tolist() == [Verdict.CONSISTENT, Verdict.LARGER]
    assert found.sentence[1].endswith("off by +0.57 deg (10 sigma)")


@pytest.mark.parametrize(("ended", "doubt"), [("finished", 0), ("converged", 0), ("diverged", 3)])
def test_a_run_that_ended_otherwise_is_lost(ended: str, doubt: int) -> None:
    nothing = np.zeros((1, 1, 1))
    found = Estimates(
        *(nothing, nothing, nothing[None], np.zeros(1, dtype=int)),
        *(nothing[0], np.ones((1, 1), dtype=int), np.array([ended])),
    )
    result = told(found, [SelfTest(np.zeros(1), 1.0, "never")])
    assert result.counts["doubt"].tolist() == [doubt]
    assert result.status.tolist() == ["consistent" if doubt == 0 else ended]


def test_a_failure_is_silent_only_without_a_word() -> None:
    nees = np.array([[1.0], [9.0], [9.0], [np.nan]])
    dof = np.array([[14.0], [14.0], [14.0], [0.0]])
    found = silent_failures({"nees": nees, "nees_dof": dof, "doubt": np.array([0, 0, 1, 0])})
    assert found["silent_failure"].tolist() == [0.0, 1.0, 0.0, 1.0]
    assert found["doubtful"].tolist() == [0.0, 0.0, 1.0, 0.0]
    assert silent_failures({"nees": nees, "nees_dof": dof}) == {}


def test_one_number_far_beyond_its_sigma_is_a_failure_whatever_the_cost_says() -> None:
    w, dof = np.ones((3, 1)), np.full((3, 1), 29.0)
    errors = {"w": w, "w_dof": dof, "doubt": np.array([0, 0, 1])}
    errors["deviation"] = np.array([[4.0], [6.0], [6.0]])
    assert silent_failures(errors)["silent_failure"].tolist() == [0.0, 1.0, 0.0]


def test_of_each_epoch_the_word_for_that_epoch_counts() -> None:
    w = np.array([[np.nan, 9.0, 1.0], [np.nan, 9.0, 1.0], [np.nan, 1.0, 9.0]])
    errors = {"w": w, "w_dof": np.where(np.isnan(w), 0.0, 29.0), "doubt": np.array([0, 0, 0])}
    errors["doubt_at"] = np.array([[np.nan, 0, 0], [np.nan, 2, 0], [np.nan, 1, 0]])
    found = silent_failures(errors)
    nan = np.nan
    np.testing.assert_array_equal(found["doubtful_at"], [[nan, 0, 0], [nan, 1, 0], [nan, 1, 0]])
    wanted = [[nan, 1, 0], [nan, 0, 0], [nan, 0, 1]]
    np.testing.assert_array_equal(found["silent_failure_at"], wanted)
    assert found["silent_failure"].tolist() == [0.0, 0.0, 1.0]
