"""Poses from points some of which are wrong, and all poses and points together."""

import numpy as np
import pytest

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.vision.bundle import Bundle, Sightings, adjusted, noise_of
from debrisest.vision.rigid_pose import RigidPose, fit
from debrisest.vision.stereo_pair import StereoPair

PAIR = StereoPair(500.0, np.array([160.0, 120.0]), 0.7)
POSE = RigidPose(
    quaternion.to_matrix(quaternion.normalize(np.array([0.9, 0.1, -0.3, 0.2]))),
    np.array([0.2, -0.1, 6.0]),
)


def cloud(count: int, draws: np.random.Generator) -> Array:
    return np.asarray(draws.uniform(-1.0, 1.0, (count, 3)))


def test_points_come_back_from_their_pixels() -> None:
    seen = POSE.of(cloud(30, np.random.default_rng(1)))
    found, covariance = PAIR.points(PAIR.project(seen))
    np.testing.assert_allclose(found, seen, atol=1e-9)
    expected = seen[:, 2] ** 2 / (PAIR.focal_px * PAIR.baseline) * np.sqrt(2.0)
    np.testing.assert_allclose(np.sqrt(covariance[:, 2, 2]), expected, rtol=0.02)


def test_a_third_of_wrong_points_is_found_out() -> None:
    draws = np.random.default_rng(2)
    body = cloud(60, draws)
    pixels = PAIR.project(POSE.of(body)) + 0.1 * draws.normal(size=(60, 2, 2))
    wrong = np.arange(60) < 20
    pixels[wrong] += draws.choice([-1.0, 1.0], (20, 1, 1)) * draws.uniform(6, 30, (20, 1, 2))
    found = fit(PAIR, body, pixels, 1.5, np.random.default_rng(0))
    assert found is not None
    pose, agree = found
    assert (agree == ~wrong).all()
    turn = quaternion.log(quaternion.from_matrix(pose.rotation @ POSE.rotation.T))
    assert np.linalg.norm(turn) < 2e-3
    np.testing.assert_allclose(pose.translation, POSE.translation, atol=0.02)


def test_points_that_agree_on_nothing_have_no_pose() -> None:
    draws = np.random.default_rng(3)
    pixels = PAIR.project(POSE.of(cloud(40, draws)))
    assert fit(PAIR, cloud(40, draws), pixels, 1.0, draws) is None
    assert fit(PAIR, np.zeros((2, 3)), np.zeros((2, 2, 2)), 1.0, draws) is None


def test_a_motion_goes_on_as_it_was() -> None:
    """About a centre that stands still: the step after is the same step."""
    step = quaternion.to_matrix(quaternion.exp(np.array([0.05, 0.1, -0.02])))
    centre, arm = np.array([0.3, 0.0, 6.0]), np.array([0.5, 0.2, 0.1])
    poses = [RigidPose(turn, centre + turn @ arm) for turn in (np.eye(3), step, step @ step)]
    expected = poses[1].after(poses[0])
    np.testing.assert_allclose(expected.rotation, poses[2].rotation, atol=1e-12)
    np.testing.assert_allclose(expected.translation, poses[2].translation, atol=1e-12)


@pytest.fixture(scope="module")
def turning() -> tuple[Bundle, Sightings, float]:
    draws, sigma = np.random.default_rng(4), 0.2
    angles = 0.14 * np.arange(12)[:, None] * np.array([0.3, 0.9, 0.2])
    turns = quaternion.to_matrix(quaternion.exp(angles)) @ POSE.rotation
    shifts = np.broadcast_to(POSE.translation, (12, 3))
    truth = Bundle(turns, shifts, cloud(80, draws))
    epoch, point = (one.ravel() for one in np.indices((12, 80)))
    plain = Sightings(epoch, point, np.zeros((0, 2, 2)))
    exact = PAIR.project(truth.seen(plain))
    return truth, plain._replace(pixels=exact + sigma * draws.normal(size=exact.shape)), sigma


def test_a_bundle_comes_to_the_truth_and_knows_its_noise(
    turning: tuple[Bundle, Sightings, float],
) -> None:
    truth, sightings, sigma = turning
    draws = np.random.default_rng(5)
    start = truth._replace(
        points=truth.points + 0.05 * draws.normal(size=truth.points.shape),
        translation=truth.translation + np.r_[np.zeros((1, 3)), 0.02 * draws.normal(size=(11, 3))],
    )
    found = adjusted(PAIR, start, sightings)
    residual = found.residuals(PAIR, sightings)
    unknowns = 6 * 11 + 3 * 80
    chi2 = float((residual**2).sum()) / sigma**2
    dof = residual.size - unknowns
    assert abs(chi2 - dof) < 5 * np.sqrt(2 * dof)
    assert noise_of(PAIR, found, sightings) == pytest.approx(sigma, rel=0.1)
    apart = found.seen(sightings) - truth.seen(sightings)
    assert np.sqrt(np.mean(apart**2)) < 0.01


def test_wrong_sightings_move_a_bundle_little(turning: tuple[Bundle, Sightings, float]) -> None:
    truth, sightings, _ = turning
    pixels = sightings.pixels.copy()
    pixels[::50] += 15.0
    apart = adjusted(PAIR, truth, sightings._replace(pixels=pixels)).seen(sightings)
    assert np.median(np.abs(apart - truth.seen(sightings))) < 0.01
