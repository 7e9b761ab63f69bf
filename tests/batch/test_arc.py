"""Torque-free arcs against integration and finite differences."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.batch.arc import Arc, along, course, displaced, moved
from debrisest.dynamics import log_inertia


@pytest.fixture(scope="module")
def arc(tumbling) -> Arc:
    return Arc(
        tumbling.times[0], tumbling.q[0], tumbling.rate[0], log_inertia.log_ratios(tumbling.inertia)
    )


def angle(q, reference: Rotation) -> float:
    found = Rotation.from_quat(q, scalar_first=True)
    return float(np.degrees((found * reference.inv()).magnitude()).max())


def test_matches_integration_of_a_body_in_any_axes(arc, tumbling) -> None:
    q, rate = along(arc, tumbling.times)
    assert angle(q, tumbling.attitude) < 1e-5
    assert np.abs(rate - tumbling.rate).max() < 1e-8


def test_moved_arc_is_the_same_motion(arc, tumbling) -> None:
    q, rate = along(moved(arc, 217.3), tumbling.times)
    assert angle(q, tumbling.attitude) < 1e-5
    assert np.abs(rate - tumbling.rate).max() < 1e-8


def test_derivatives_match_wide_central_differences(arc, tumbling) -> None:
    times = tumbling.times[::40]
    found = course(arc, times)
    for unknown in range(11):
        step = np.zeros(11)
        step[unknown] = 1e-6
        (ahead, rate_ahead), (back, rate_back) = (
            along(displaced(arc, sign * step), times) for sign in (1.0, -1.0)
        )
        turn = (
            Rotation.from_quat(ahead, scalar_first=True)
            * Rotation.from_quat(back, scalar_first=True).inv()
        ).as_rotvec()
        scale = 1.0 + np.abs(found.turn_by[..., unknown]).max()
        assert np.abs(turn / 2e-6 - found.turn_by[..., unknown]).max() < 1e-3 * scale
        rate = (rate_ahead - rate_back) / 2e-6
        assert np.abs(rate - found.rate_by[..., unknown]).max() < 1e-3 * scale
