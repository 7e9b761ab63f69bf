"""Data that tell next to nothing, or nothing but noise, give a status and never an exception."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.batch.estimate import (
    estimate_from_attitudes,
    estimate_from_points,
    estimate_from_rates,
)
from debrisest.batch.motion import Status


@pytest.mark.parametrize("epochs", [0, 1, 2, 6, 12])
def test_few_epochs(tumbling, box, epochs) -> None:
    times = tumbling.times[:epochs]
    points = tumbling.points(np.random.default_rng(0), 0.05)[:epochs]
    q, rate = tumbling.q[:epochs], tumbling.rate[:epochs]
    for motion in (
        estimate_from_points(times, points, 0.05, box),
        estimate_from_points(times, points, None),
        estimate_from_attitudes(times, q, 0.02),
        estimate_from_rates(times, rate),
    ):
        assert motion.status not in (Status.ACCEPTED, Status.ACCEPTED_IN_PART)
        assert len(motion.path.q) == epochs


@pytest.mark.parametrize("known", [True, False])
def test_points_that_are_noise_alone(tumbling, box, known) -> None:
    points = np.random.default_rng(1).normal(size=(len(tumbling.times), 8, 3))
    motion = estimate_from_points(tumbling.times, points, 0.05, box if known else None)
    assert not motion.status.accepted


@pytest.mark.parametrize("known", [True, False])
def test_points_in_line_have_no_attitude(tumbling, known) -> None:
    line = np.outer(np.arange(5.0), [0.0, 0.0, 1.0])
    points = np.einsum("kij,cj->kci", tumbling.attitude.as_matrix(), line)
    points += 0.05 * np.random.default_rng(2).normal(size=points.shape)
    motion = estimate_from_points(tumbling.times, points, 0.05, line if known else None)
    assert motion.status is Status.TOO_FEW


def test_attitudes_without_any_motion_in_them(tumbling) -> None:
    q = Rotation.random(100, rng=np.random.default_rng(3)).as_quat(scalar_first=True)
    assert not estimate_from_attitudes(tumbling.times[:100], q, 0.05).status.accepted


def test_no_attitude_at_all(tumbling) -> None:
    motion = estimate_from_attitudes(tumbling.times, np.full((len(tumbling.times), 4), np.nan), 0.1)
    assert motion.status is Status.TOO_FEW


def test_points_without_noise(tumbling, box) -> None:
    points = tumbling.points(np.random.default_rng(4), 0.0)
    motion = estimate_from_points(tumbling.times, points, None, box)
    assert motion.status is Status.ACCEPTED
    error = Rotation.from_quat(motion.path.q, scalar_first=True) * tumbling.attitude.inv()
    assert error.magnitude().max() < 1e-6


def test_a_body_at_rest(body_of, box) -> None:
    truth = body_of(np.arange(0.0, 200.0), [0.0, 0.0, 0.0], [1.0, 0.8, 0.6])
    points = truth.points(np.random.default_rng(5), 0.05)
    motion = estimate_from_points(truth.times, points, 0.05, box)
    assert motion.status is Status.WITHOUT_INERTIA
    assert np.all(np.abs(motion.path.rate) < 5.0 * motion.path.rate_sigma)
