"""The second stage against angles that are differenced along a turning body."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from debrisest.control import two_stage
from debrisest.control.attitude_hold import GAINS, hold_attitude
from debrisest.control.rigid_spacecraft import spacecraft
from debrisest.control.robust_term import Uncertainty
from debrisest.control.two_stage import Controller, Switch, advance, start

STEP = 1e-4
UNSURE = Uncertainty(drift=0.1, gain=0.4)


def tilted(seed: int) -> tuple[np.ndarray, ...]:
    """Angles with a large tilt, a large rate, angles to hold, and an integral."""
    rng = np.random.default_rng(seed)
    angles = rng.uniform(-1.0, 1.0, 3)
    angles[1] = rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.0)
    return angles, rng.uniform(-1.0, 1.0, 3), angles + rng.normal(size=3), 5.0 * rng.normal(size=3)


def motion(inertia, angles, rate, torque) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative of the angles, by differences."""
    spin_up = np.linalg.solve(inertia, torque - np.cross(rate, inertia @ rate))
    body = Rotation.from_euler("ZYX", angles[::-1])
    behind, ahead = (
        (body * Rotation.from_rotvec(h * rate + 0.5 * h * h * spin_up)).as_euler("ZYX")[::-1]
        for h in (-STEP, STEP)
    )
    return (ahead - behind) / (2 * STEP), (ahead - 2 * angles + behind) / STEP**2


@pytest.mark.parametrize("reading", ["none", "literal", "sign"])
@given(seed=st.integers(0, 10**6))
def test_the_angles_get_the_second_derivative_that_is_wanted(reading, seed, inertia) -> None:
    angles, rate, desired, integral = tilted(seed)
    given_now = desired, angles, rate, integral
    demand = hold_attitude(spacecraft(inertia), GAINS, UNSURE, reading, *given_now)
    error = desired - angles
    np.testing.assert_allclose(demand.growth, error)
    angle_rate, drift = motion(inertia, angles, rate, np.zeros(3))
    v = 10.0 * error - angle_rate - drift
    s = 10.0 * integral + error - angle_rate
    robust = {
        "none": np.zeros(3),
        "literal": (0.1 * np.abs(drift) + 0.4 * v + 0.001 * s) / 0.6,
        "sign": np.sign(s) * (0.1 * np.abs(drift) + 0.4 * np.abs(v) + 0.001 * np.abs(s)) / 0.6,
    }
    _, reached = motion(inertia, angles, rate, demand.torque)
    np.testing.assert_allclose(reached, drift + v + robust[reading], atol=1e-4)


def test_the_error_is_integrated_while_the_attitude_is_held(inertia) -> None:
    craft, still = spacecraft(inertia), np.zeros((1, 1, 3))
    desired, angles = np.array([[[0.1, 0.2, -0.3]]]), np.array([[[0.0, 0.3, 0.1]]])
    memory = start(np.full((1, 1, 2), np.nan), desired)
    controller = Controller(craft, np.array([[335.0]]), switch=Switch(hold=1.0))
    nothing_seen = np.full((1, 1, 2), np.nan)
    for count in (1, 2, 3):
        torque, memory = advance(controller, memory, nothing_seen, angles, still, 0.5)
        np.testing.assert_allclose(memory.holding_integral, 0.5 * count * (desired - angles))
        assert np.abs(torque).max() > 0.0
    assert memory.stage.tolist() == [[two_stage.DONE]]
    limited = controller._replace(torque_limit=1e-9)
    _, after = advance(limited, memory, nothing_seen, angles, still, 0.5)
    np.testing.assert_array_equal(after.holding_integral, memory.holding_integral)
