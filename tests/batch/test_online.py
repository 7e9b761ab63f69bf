"""The batch on the data so far: nothing of later epochs, and as large errors as it says."""

import numpy as np
import pytest

from debrisest.batch.estimate import estimate_from_points
from debrisest.batch.online import epochs_of_runs, online

SIGMA, EPOCHS = 0.05, 120


def stretches(truth, points, model, epochs=None):
    times = truth.times[:epochs]

    def so_far(count, near, at):
        return estimate_from_points(times[:count], points[:count], SIGMA, model, near, at)

    return list(online(so_far, times))


@pytest.fixture(scope="module")
def points(tumbling):
    return [tumbling.points(np.random.default_rng(seed), SIGMA) for seed in (1, 2)]


@pytest.fixture(scope="module")
def found(tumbling, box, points):
    return [stretches(tumbling, one, box, EPOCHS) for one in points]


def test_the_batch_is_run_less_and_less_often() -> None:
    epochs = epochs_of_runs(np.arange(0.0, 1500.0))
    assert epochs[:12] == [*range(10, 111, 10), 121] and epochs[-1] == 1499
    waits = np.diff(epochs[10:-1])
    assert np.all(waits >= 10) and np.all(np.abs(waits - 0.1 * np.array(epochs[10:-2])) <= 2.0)
    assert len(epochs) < 45


def test_later_epochs_are_not_known(tumbling, box, points, found) -> None:
    spoilt = points[0].copy()
    spoilt[60:] += np.random.default_rng(0).normal(size=spoilt[60:].shape)
    early = stretches(tumbling, spoilt, box, 71)
    seen = 0
    for mine, theirs in zip(early, found[0]):
        if np.searchsorted(tumbling.times, mine.path.times[0]) < 60:
            np.testing.assert_array_equal(mine.path.q, theirs.path.q)
            seen += 1
    assert seen >= 3


def test_the_last_epoch_knows_all_that_the_batch_knows(tumbling, box, points, found) -> None:
    for one, run in zip(points, found):
        whole = estimate_from_points(tumbling.times[:EPOCHS], one[:EPOCHS], SIGMA, box)
        last = run[-1].motion
        assert len(run[-1].path.times) == 1 and last.status is whole.status
        gap = np.abs(last.path.rate - whole.path.rate)
        assert np.all(gap <= 0.05 * whole.path.rate_sigma)


def test_rate_errors_are_as_large_as_their_covariance(tumbling, found) -> None:
    """Mean square per component at the ends of runs, whose errors may all be alike: five sigma."""
    squares = []
    for run in found:
        for stretch in run:
            k = np.searchsorted(tumbling.times, stretch.path.times[-1])
            error = stretch.path.rate[-1] - tumbling.rate[k]
            spread = stretch.path.rate_covariance[-1]
            squares.append(error @ np.linalg.solve(spread, error) / 3.0)
    mean = float(np.mean(squares))
    assert abs(mean - 1.0) < 5.0 * np.sqrt(2.0 / (3.0 * len(found)))
    assert all(stretch.motion.status.accepted for run in found for stretch in run[3:])
