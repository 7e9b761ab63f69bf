"""The spacecraft against scipy's integrator, in the units of the paper."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from debrisest.control.rigid_spacecraft import reference_rate_b, spacecraft

PRINTED_G_CM2 = [[10662.54, -40.20, 73.65], [-40.20, 10415.43, 48.15], [73.65, 48.15, 9618.74]]
ARM, MASS = 0.01, 1e-3
"""A gram on an arm of a centimetre is a gram square centimetre."""
INERTIA = np.array(PRINTED_G_CM2) * MASS * ARM**2


def test_recorded_torques_give_the_recorded_rates_and_attitudes(turn) -> None:
    """Euler's equations and quaternions; a torque in other units would turn another body."""
    flown = turn(np.array([[237.6, -42.3]]), np.array([[0.02, -0.05, 0.08]]), seconds=2.0)
    rate, rotation = flown.rate_b[0, 0], Rotation.identity()
    ray = np.array([237.6 / 335.0, -1.0, -42.3 / 335.0])

    def slope(_: float, y: np.ndarray, torque: np.ndarray) -> np.ndarray:
        w, (q0, q) = y[:3], (y[3], y[4:])
        spin_up = np.linalg.solve(INERTIA, torque - np.cross(w, INERTIA @ w))
        return np.concatenate([spin_up, [-0.5 * q @ w], 0.5 * (q0 * w + np.cross(q, w))])

    for pixel, recorded, torque in zip(flown.pixel, flown.rate_b, flown.torque):
        np.testing.assert_allclose(rate, recorded[0], atol=1e-8)
        seen = rotation.inv().apply(ray)
        np.testing.assert_allclose(pixel[0], 335.0 * seen[[0, 2]] / -seen[1], atol=1e-3)
        start = np.concatenate([rate, rotation.as_quat(scalar_first=True)])
        end = solve_ivp(slope, (0.0, 0.02), start, rtol=1e-10, atol=1e-12, args=(torque[0],))
        rate, rotation = end.y[:3, -1], Rotation.from_quat(end.y[3:, -1], scalar_first=True)


def test_axes_that_turn_leave_a_body_at_rest_behind() -> None:
    craft, still = spacecraft(INERTIA), np.zeros(3)
    turning, angles, rate = np.array([0.0, 1.2e-3, 0.0]), np.array([0.1, -0.2, 0.7]), np.zeros(3)
    start = Rotation.from_euler("ZYX", angles[::-1])
    for _ in range(100):
        angles, rate = craft.move(angles, rate, still, turning, 1.0)
    end = Rotation.from_rotvec(-100.0 * turning) * start
    np.testing.assert_allclose(angles, end.as_euler("ZYX")[::-1], atol=1e-9)
    np.testing.assert_allclose(reference_rate_b(angles, turning), end.inv().apply(turning))


@pytest.mark.parametrize(
    ("inertia", "word"),
    [
        (np.zeros((3, 3)), "positive"),
        (np.diag([1.0, 1.0, -1.0]), "positive"),
        (np.array([[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), "symmetric"),
        (np.diag([1.0, 1.0, 3.0]), "no body"),
    ],
)
def test_inertia_that_no_body_has_is_refused(inertia, word) -> None:
    with pytest.raises(ValueError, match=word):
        spacecraft(inertia)
