"""Motion from points: right where it is accepted, and refused where it is not torque-free."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.batch.descent import PRIOR_SIGMA
from debrisest.batch.estimate import estimate_from_points
from debrisest.batch.motion import Judged, Status
from debrisest.batch.observability import inertia_directions
from debrisest.dynamics import log_inertia

FIVE_SIGMA = 31.8  # chi-square of three, as seldom exceeded as five sigma


def assert_right(truth, motion, at_epoch=False) -> None:
    assert motion.status.accepted
    for square in truth.errors(motion, at_epoch):
        assert np.all(square < FIVE_SIGMA)


def inertia_square(truth, motion) -> float:
    error = motion.arc.log_inertia - log_inertia.log_ratios(truth.inertia)
    return float(error @ np.linalg.solve(motion.covariance[6:, 6:], error))


def test_known_points_are_consistent(tumbling, box) -> None:
    """Normalised squares of the 11 unknowns over eight noises: chi-square of 88, to five sigma."""
    total = 0.0
    for seed in range(8):
        points = tumbling.points(np.random.default_rng(seed), 0.05)
        motion = estimate_from_points(tumbling.times, points, 0.05, box)
        assert_right(tumbling, motion)
        assert motion.judged is Judged.CHI_SQUARE_AND_BLOCKS
        assert motion.status is Status.ACCEPTED
        k = int(np.argmin(np.abs(tumbling.times - motion.arc.epoch)))
        estimated = motion.at(tumbling.times[[k]])
        turn = Rotation.from_quat(estimated.q[0], scalar_first=True) * tumbling.attitude[k].inv()
        total += turn.as_rotvec() @ np.linalg.solve(estimated.turn_covariance[0], turn.as_rotvec())
        off = estimated.rate[0] - tumbling.rate[k]
        total += off @ np.linalg.solve(estimated.rate_covariance[0], off)
        total += inertia_square(tumbling, motion)
    assert abs(total - 88.0) < 5.0 * np.sqrt(2.0 * 88.0)


def test_noise_that_is_not_given_is_found(tumbling, box) -> None:
    points = tumbling.points(np.random.default_rng(1), 0.05)
    motion = estimate_from_points(tumbling.times, points, None, box)
    assert_right(tumbling, motion)
    assert motion.judged is Judged.NOISE_UNKNOWN
    assert abs(motion.noise / 0.05 - 1.0) < 5.0 / np.sqrt(2.0 * motion.fit.dof)


def test_noise_larger_than_said_is_told(tumbling, box) -> None:
    points = tumbling.points(np.random.default_rng(1), 0.05)
    motion = estimate_from_points(tumbling.times, points, 0.04, box)
    assert_right(tumbling, motion)
    assert motion.judged is Judged.NOISE_LARGER
    assert motion.noise == pytest.approx(1.25, abs=0.05)


def test_unknown_points(tumbling, box) -> None:
    points = tumbling.points(np.random.default_rng(1), 0.05)
    motion = estimate_from_points(tumbling.times, points, 0.05)
    assert motion.status.accepted
    assert motion.kept.all()
    middle = motion.arc.epoch
    named = motion.at(np.array([middle]))
    assert np.abs(named.turn_covariance).max() < 1e-15
    shape = np.linalg.norm(motion.points[:, None] - motion.points, axis=-1)
    true = np.linalg.norm(box[:, None] - box, axis=-1)
    assert np.abs(shape - true).max() < 5.0 * 2.0 * motion.points_sigma.max()
    moments = np.linalg.eigvalsh(log_inertia.inertia(motion.arc.log_inertia))
    true_moments = np.linalg.eigvalsh(tumbling.inertia)
    ratio = np.log(moments / np.cbrt(moments.prod()))
    expected = np.log(true_moments / np.cbrt(true_moments.prod()))
    sigma, _ = inertia_directions(motion.covariance)
    assert np.abs(ratio - expected).max() < 5.0 * sigma.max()


def test_a_body_that_is_pushed_is_refused_and_still_followed(body_of, box) -> None:
    """A steady torque: no inertia, but attitude and rate within their sigmas."""
    times = np.arange(0.0, 300.0)
    inertia = [1.0, 0.8, 0.55]
    truth = body_of(times, [4.0, -3.0, 5.0], inertia, lambda t: np.array([3e-4, 0.0, -2e-4]))
    points = truth.points(np.random.default_rng(3), 0.05)
    motion = estimate_from_points(times, points, 0.05, box)
    assert motion.status is Status.NOT_TORQUE_FREE
    assert motion.arc is None
    assert motion.holds[1] - motion.holds[0] < 300.0
    turn, rate = truth.errors(motion)
    known = np.isfinite(turn)
    assert known.sum() > 290
    assert np.mean(turn[known] < 14.2) > 0.95  # three sigma, in three directions
    assert np.mean(rate[known] < 14.2) > 0.95


@pytest.mark.parametrize("share", [0.05, 0.2])
def test_wrong_matches(tumbling, box, share) -> None:
    rng = np.random.default_rng(4)
    points = tumbling.points(rng, 0.05)
    wrong = rng.uniform(size=points.shape[:2]) < share
    points[wrong] += 2.0 * rng.normal(size=(int(wrong.sum()), 3))
    motion = estimate_from_points(tumbling.times, points, 0.05, box)
    assert_right(tumbling, motion)
    assert 0.5 * share < motion.rejected < 1.5 * share


def test_a_feature_that_is_elsewhere_is_dropped_by_name(tumbling, box) -> None:
    points = tumbling.points(np.random.default_rng(6), 0.05)
    model = box.copy()
    model[4] += [0.08, -0.06, 0.05]
    motion = estimate_from_points(tumbling.times, points, 0.05, model)
    assert np.flatnonzero(~motion.kept).tolist() == [4]
    assert_right(tumbling, motion)


def test_the_larger_of_two_bodies_is_kept(tumbling, body_of, box) -> None:
    rng = np.random.default_rng(7)
    other = body_of(tumbling.times, [-2.0, 6.0, 1.0], [1.0, 0.7, 0.6])
    both = np.hstack([tumbling.points(rng, 0.03), 9.0 + other.points(rng, 0.03, box[:5])])
    motion = estimate_from_points(tumbling.times, both, 0.03)
    assert motion.status.accepted
    assert motion.kept.tolist() == [True] * 8 + [False] * 5
    assert np.array_equal(motion.other_body, ~motion.kept)


def test_a_steady_spin_shows_attitude_and_not_inertia(body_of, box) -> None:
    truth = body_of(np.arange(0.0, 400.0), [0.0, 0.0, 5.0], [1.0, 0.8, 0.55])
    motion = estimate_from_points(
        truth.times, truth.points(np.random.default_rng(8), 0.05), 0.05, box
    )
    assert_right(truth, motion)
    assert motion.status is Status.WITHOUT_INERTIA
    assert np.allclose(inertia_directions(motion.claimed)[0], PRIOR_SIGMA)


def test_too_few_epochs_say_what_is_needed(tumbling, box) -> None:
    points = tumbling.points(np.random.default_rng(9), 0.05)[:4]
    motion = estimate_from_points(tumbling.times[:4], points, 0.05, box)
    assert motion.status is Status.TOO_FEW
    assert "six epochs" in motion.status.sentence
    assert np.isnan(motion.path.rate).all()


def test_nothing_seen_is_too_few(tumbling, box) -> None:
    points = np.full((5, 8, 3), np.nan)
    for model in (None, box):
        for sigma in (None, 0.05):
            motion = estimate_from_points(tumbling.times[:5], points, sigma, model)
            assert motion.status is Status.TOO_FEW
