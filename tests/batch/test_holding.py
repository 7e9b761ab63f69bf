"""The time from which torque-free motion fails, of bodies that are pushed from a known time on."""

import numpy as np
import pytest

from debrisest.batch.estimate import estimate_from_points
from debrisest.batch.motion import Status

PUSH = np.array([0.05, 0.0, -0.03])  # N m per kg m^2


@pytest.fixture(scope="module")
def refused(body_of, box):
    """Motions of a body that is pushed after 260 s, and of one that is until 140 s, of 400 s."""

    def motion(torque):
        truth = body_of(np.arange(0.0, 400.0), [4.0, -3.0, 5.0], [1.0, 0.8, 0.55], torque)
        points = truth.points(np.random.default_rng(8), 0.05)
        return estimate_from_points(truth.times, points, 0.05, box)

    weak = 0.004 * PUSH
    late = motion(lambda t: weak * (t > 260.0))
    early = motion(lambda t: weak * (t < 140.0))
    return late, early


def test_it_is_told_from_when_on_the_motion_fails(refused) -> None:
    late, _ = refused
    assert late.status is Status.NOT_TORQUE_FREE
    assert late.holds[0] == 0.0
    assert 250.0 < late.holds[1] < 300.0


def test_it_is_told_from_when_on_the_motion_holds(refused) -> None:
    _, early = refused
    assert early.status is Status.NOT_TORQUE_FREE
    assert 100.0 < early.holds[0] < 150.0
    assert early.holds[1] == 399.0
