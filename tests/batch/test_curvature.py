"""Claims about an inertia that the motion hardly shows: the valley of its chi-square bends."""

import numpy as np
import pytest

from debrisest.batch.arc import Arc, displaced
from debrisest.batch.descent import PRIOR_SIGMA, covariance, descend
from debrisest.batch.estimate import estimate_from_points
from debrisest.batch.motion import Status
from debrisest.batch.observability import LOST, inertia_directions
from debrisest.batch.spread import Sides, Spread, shift
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


def test_the_floor_along_a_direction_leaves_what_is_known_less_where_it_is(motions) -> None:
    """Left to itself it runs off along the worst one, whose own floor says so again."""
    for motion in motions:
        _, directions = inertia_directions(covariance(descend(motion.evidence, motion.arc, 5).hold))
        axes = motion.spread.axes
        for ends in (axes.ahead, axes.behind):
            way = shift(motion.arc, ends)[-5:, 6:] @ directions
            worse = np.triu(way, 1) / np.diag(way)[None, :]
            assert np.abs(worse).max() < 0.05


def test_an_axis_that_bends_like_an_s_is_covered_on_its_way() -> None:
    """``x = s, y = 0.1 (s / 3)^3``: in the middle of either side it is far off the line."""
    arc = Arc(0.0, np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3), np.zeros(5))

    def sides(x: float, y: float, far: float) -> Sides:
        error = np.zeros((1, 11))
        error[0, 6:8] = x, y
        return Sides(displaced(arc, error), displaced(arc, -error), np.full((2, 1), far))

    none = Sides.straight(arc, np.zeros((0, 11)))
    ends, begins = sides(3.0, 0.1, 3.0), sides(0.1, 0.0, 0.1)
    s = np.linspace(0.0, 3.0, 31)
    off = np.stack([s, 0.1 * (s / 3.0) ** 3], axis=-1)
    for extra, covered in (((ends, begins), True), ((none, none), False)):
        claimed = Spread(ends, none, none, *extra).covariance(arc)[6:8, 6:8] + 1e-6 * np.eye(2)
        sigmas = np.sqrt(np.sum(off @ np.linalg.inv(claimed) * off, axis=-1))
        assert (sigmas.max() < 3.0 * np.sqrt(2.0)) == covered
