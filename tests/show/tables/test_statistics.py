"""Statistics against hand-computed values; the coverage of the bootstrap interval."""

from math import comb

import numpy as np
import pytest

from debrisest.assessment.statistics import STATISTICS, bootstrap, per_run, window_mask

# three runs, four epochs
ERRORS = np.array([[3.0, -4.0, 0.0, 5.0], [1.0, 1.0, -1.0, -1.0], [0.0, 2.0, 2.0, 4.0]])
ALL = np.ones(4, dtype=bool)
RMS = [np.sqrt(50 / 4), 1.0, np.sqrt(24 / 4)]
ABSOLUTE = [3.0, 1.0, 2.0]

BY_HAND = {
    "rmse": (RMS, np.mean(RMS)),
    "rms": (RMS, np.sqrt((50 + 4 + 24) / 12)),
    "median": (RMS, np.sqrt(6)),
    "p50": (ABSOLUTE, 2.0),
    "p70": (ABSOLUTE, 2.4),
    "p90": (ABSOLUTE, 2.8),
    "p100": (ABSOLUTE, 3.0),
    "mean": ([1.0, 0.0, 2.0], 1.0),
    "value": ([1.0, 0.0, 2.0], 1.0),
    "share": ([1.0, 0.0, 2.0], 1.0),
    "ever": ([5.0, 1.0, 4.0], 10 / 3),
}


def test_every_statistic_has_a_hand_computed_value() -> None:
    assert BY_HAND.keys() == STATISTICS.keys()


@pytest.mark.parametrize("name", BY_HAND)
def test_statistics_by_hand(name: str) -> None:
    each, together = BY_HAND[name]
    assert per_run(name, ERRORS, ALL) == pytest.approx(each)
    assert bootstrap(name, [per_run(name, ERRORS, ALL)], 0)[0] == pytest.approx(together)


def test_only_the_window_counts() -> None:
    inside = np.array([False, True, True, False])
    assert per_run("rmse", ERRORS, inside) == pytest.approx([np.sqrt(8), 1.0, 2.0])


def test_a_figure_per_run_needs_no_window() -> None:
    settling = np.array([30.0, 10.0, 20.0])
    assert per_run("median", settling, np.zeros(4, dtype=bool)).tolist() == [30.0, 10.0, 20.0]
    assert bootstrap("median", [settling], 0)[0] == 20.0


@pytest.mark.parametrize(
    ("window", "inside"),
    [
        ((0.0, 2.0), [0, 1]),
        ((0.5, 2.5), [1, 2]),
        ((0.0, 4.0), [0, 1, 2, 3]),
        ((0.0, 0.0), [0]),
        ((4.0, 4.0), [3]),
        ((1.4, 1.4), [1]),
        ((9.0, 12.0), []),
    ],
)
def test_windows_are_half_open_and_instants_take_the_nearest_epoch(
    window: tuple[float, float], inside: list[int]
) -> None:
    assert np.flatnonzero(window_mask(np.arange(4.0), window)).tolist() == inside


def test_a_mean_weighs_its_cases_alike() -> None:
    """Means over cases do not depend on how many runs a case has."""
    figures = [np.full(100, 1.0), np.full(2, 4.0)]
    assert bootstrap("rmse", figures, 0) == (2.5, 2.5, 2.5)


def test_runs_are_resampled_within_their_case() -> None:
    """Cases that differ widely, of runs that agree, leave no doubt about their mean."""
    rng = np.random.default_rng(1)
    figures = [centre + 0.01 * rng.standard_normal(20) for centre in (1.0, 50.0, 200.0)]
    middle, low, high = bootstrap("rmse", figures, 0)
    error = 0.01 / np.sqrt(60)
    assert middle == pytest.approx(np.mean(figures))
    assert 2 * error < high - low < 6 * error
    pooled = bootstrap("rmse", [np.concatenate(figures)], 0)
    assert pooled[2] - pooled[1] > 1000 * (high - low)


def test_the_interval_is_that_of_the_normal_distribution_for_many_runs() -> None:
    figures = np.random.default_rng(2).normal(10.0, 3.0, 400)
    middle, low, high = bootstrap("mean", [figures], 0)
    half = 1.96 * figures.std() / 20
    assert [low, high] == pytest.approx([middle - half, middle + half], abs=0.15 * half)


@pytest.mark.parametrize("groups", [[], [np.array([])], [np.array([1.0]), np.array([])]])
def test_without_runs_there_is_no_figure(groups: list[np.ndarray]) -> None:
    assert np.isnan(bootstrap("rmse", groups, 0)).all()


def test_a_single_run_is_its_own_interval() -> None:
    assert bootstrap("rmse", [np.array([2.0])], 0) == (2.0, 2.0, 2.0)


def test_the_same_seed_gives_the_same_interval() -> None:
    figures = [np.random.default_rng(0).random(20)]
    assert bootstrap("mean", figures, 5) == bootstrap("mean", figures, 5)
    assert bootstrap("mean", figures, 5) != bootstrap("mean", figures, 6)


# coverage

TRIALS = 200


def covered(spread: float = 1.0, runs: int = 40) -> int:
    """Return in how many trials the interval holds the true mean; ``spread`` mistunes it."""
    rng = np.random.default_rng(20)
    hits = 0
    for trial in range(TRIALS):
        figures = rng.normal(5.0, 1.0, runs)
        middle, low, high = bootstrap("mean", [figures], trial)
        hits += middle + spread * (low - middle) <= 5.0 <= middle + spread * (high - middle)
    return hits


def binomial_tail(count: int, share: float, below: bool) -> float:
    terms = range(count + 1) if below else range(count, TRIALS + 1)
    return sum(comb(TRIALS, k) * share**k * (1 - share) ** (TRIALS - k) for k in terms)


def test_the_interval_covers_the_truth_as_often_as_it_says() -> None:
    """The percentile bootstrap of 40 runs covers in 93.4 to 95 % (its variance lacks 1/40)."""
    hits = covered()
    assert binomial_tail(hits, 0.934, below=True) > 1e-4
    assert binomial_tail(hits, 0.95, below=False) > 1e-4


@pytest.mark.parametrize("spread", [0.5, 2.0])
def test_a_mistuned_interval_is_noticed(spread: float) -> None:
    hits = covered(spread)
    low = binomial_tail(hits, 0.934, below=True)
    high = binomial_tail(hits, 0.95, below=False)
    assert min(low, high) < 1e-4


def test_the_rms_of_a_diverged_run_may_be_infinite() -> None:
    assert per_run("rmse", np.full((1, 4), 1e200), ALL) == [np.inf]
