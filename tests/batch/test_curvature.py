"""Claims about an inertia that the motion hardly shows: the valley of its chi-square bends."""

import numpy as np
import pytest

from debrisest.batch.descent import PRIOR_SIGMA, covariance, descend
from debrisest.batch.estimate import estimate_from_points
from debrisest.batch.motion import Status
from debrisest.batch.observability import LOST, inertia_directions
from debrisest.dynamics import log_inertia

SLENDER = np.diag([0.275, 1.0, 1.0])


@pytest.fixture(scope="module")
def motions(body_of, box):
    """A slender axisymmetric body that tumbles almost flat, under the noise of six seeds."""
    truth = body_of(np.arange(0.0, 400.0), [0.2, 3.0, 0.0], SLENDER)
    return [
        estimate_from_points(
            truth.times, truth.points(np.random.default_rng(seed), 0.05), 0.05, box
        )
        for seed in range(6)
    ]


def largest_error(motion, spread) -> float:
    """Largest error over its sigma in the directions that are shown."""
    sigma, directions = inertia_directions(spread)
    error = np.abs(directions.T @ (motion.arc.log_inertia - log_inertia.log_ratios(SLENDER)))
    return float(np.max(error / sigma, where=sigma < LOST * PRIOR_SIGMA, initial=0.0))


def test_what_is_claimed_of_a_bent_valley_holds(motions) -> None:
    assert all(motion.status.accepted for motion in motions)
    assert max(largest_error(motion, motion.claimed) for motion in motions) < 5.0


def test_the_covariance_at_the_floor_would_have_claimed_too_much(motions) -> None:
    floors = [covariance(descend(motion.evidence, motion.arc, 5).hold) for motion in motions]
    assert max(largest_error(*pair) for pair in zip(motions, floors)) > 5.0


def test_a_direction_whose_valley_is_flat_is_not_shown(motions) -> None:
    shown = [motion for motion in motions if motion.status is not Status.WITHOUT_INERTIA]
    assert all(motion.status is Status.ACCEPTED_IN_PART for motion in shown)


def test_a_straight_valley_is_left_as_it_is(tumbling, box) -> None:
    points = tumbling.points(np.random.default_rng(7), 0.005)
    motion = estimate_from_points(tumbling.times, points, 0.005, box)
    plain = np.diag(covariance(descend(motion.evidence, motion.arc, 5).hold))
    np.testing.assert_allclose(np.diag(motion.covariance), plain, rtol=0.05)
