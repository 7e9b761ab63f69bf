"""The printed equations of Pesce et al. (2017) that are wrong, each shown to be wrong."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.dynamics.inertia_ratios import ratios
from debrisest.dynamics.kepler import MU_EARTH
from debrisest.dynamics.relative_orbit import leader_orbit, relative_acceleration
from debrisest.dynamics.relative_rotation import rotate
from debrisest.sensors import stereo

AXIS, ECCENTRICITY = 7.17e6, 0.05
POSITION, VELOCITY = np.array([10.0, 60.0, 10.0]), np.array([0.01, -0.0225, -0.01])
RATES = {"A": np.radians([-0.1, -0.1, 0.034]), "C": np.radians([-1.0, -1.0, 0.934])}
Q_LT = np.array([0.0, 0.0, 0.0, 1.0])
LEADER = leader_orbit(np.zeros(1), AXIS, ECCENTRICITY, 0.0).at(0)
INERTIA = np.array([0.83, 1.0, 1.083])


def inertial_acceleration():
    """Difference of two pulls, in the leader's axes, seen from those turning axes."""
    leader = np.array([LEADER.radius, 0.0, 0.0])
    spin = np.array([0.0, 0.0, LEADER.rate])
    target = leader + POSITION
    pull = MU_EARTH * (leader / LEADER.radius**3 - target / np.linalg.norm(target) ** 3)
    turning = 2 * np.cross(spin, VELOCITY) + np.cross(spin, np.cross(spin, POSITION))
    return pull - turning - np.cross([0.0, 0.0, LEADER.acceleration], POSITION)


def test_gravity_of_equation_11_repels():
    """Both signs are turned; half of the 86 km after 100 s is 1/2 a t^2 of the difference."""
    right = relative_acceleration(POSITION, VELOCITY, LEADER)
    np.testing.assert_allclose(right, inertial_acceleration(), atol=1e-13)
    distance = np.hypot.reduce(POSITION + np.array([LEADER.radius, 0.0, 0.0]))
    gravity = -MU_EARTH * (LEADER.radius + POSITION[0]) / distance**3 + MU_EARTH / LEADER.radius**2
    printed = MU_EARTH * (LEADER.radius + POSITION[0]) / distance**3 + MU_EARTH / LEADER.radius**2
    assert abs(gravity) < 1e-4
    assert 0.5 * printed * 100.0**2 == pytest.approx(85.7e3, rel=0.02)


def test_rate_of_equation_14():
    """The printed rate sweeps no equal areas; the right one makes the paper's rates round."""
    parameter = AXIS * (1 - ECCENTRICITY**2)
    printed = np.sqrt(MU_EARTH / parameter**3 * (1 + ECCENTRICITY) ** 2)
    assert np.degrees(printed) == pytest.approx(0.0628, abs=5e-5)
    assert np.degrees(LEADER.rate) == pytest.approx(0.0659, abs=5e-5)
    for rate, size in ((RATES["A"], 0.1), (RATES["C"], 1.0)):
        total = rate + np.array([0.0, 0.0, LEADER.rate])
        rate_t = rotate(Q_LT * [1, -1, -1, -1], total)
        np.testing.assert_allclose(np.degrees(rate_t), size, atol=1e-4)


def test_equation_17_lacks_the_turning_axes():
    """With the printed term, a target at rest in inertial axes would be accelerated."""
    spin = np.array([0.0, 0.0, LEADER.rate])
    rate = RATES["C"]
    step = 1e-3
    turned = Rotation.from_rotvec(-spin * step)
    seen_later = turned.apply(rate + spin) - spin
    np.testing.assert_allclose((seen_later - rate) / step, -np.cross(spin, rate), atol=1e-8)
    printed = -np.cross(spin, spin)
    assert np.degrees(np.linalg.norm(printed + np.cross(spin, rate))) * 100 > 0.1


def test_equation_18_takes_the_rate_in_the_targets_axes():
    q = Rotation.from_euler("xyz", [0.4, -0.8, 1.1]).as_quat(scalar_first=True)
    rate_l, step = RATES["C"], 1e-4
    q0, q1, q2, q3 = q
    printed = np.array([[-q1, -q2, -q3], [q0, -q3, q2], [q3, q0, -q1], [-q2, q1, q0]])
    right = np.array([[-q1, -q2, -q3], [q0, q3, -q2], [-q3, q0, q1], [q2, -q1, q0]])
    later = Rotation.from_rotvec(rate_l * step) * Rotation.from_quat(q, scalar_first=True)
    derivative = (later.as_quat(scalar_first=True) - q) / step
    np.testing.assert_allclose(0.5 * right @ rate_l, derivative, atol=1e-6)
    assert np.abs(0.5 * printed @ rate_l - derivative).max() > 1e-3


@pytest.mark.parametrize(("case", "least"), [("A", 1e-3), ("C", 1e-2)])
def test_flow_of_equations_24_to_27(case, least):
    """The printed flow is many times as wrong as the flow is large."""
    rate = RATES[case]
    arms = np.random.default_rng(0).uniform(-1.5, 1.5, (100, 3))
    points, velocities = POSITION + arms, VELOCITY + np.cross(rate, arms)
    step = 1e-2
    ahead = POSITION + step * VELOCITY + Rotation.from_rotvec(step * rate).apply(arms)
    behind = POSITION - step * VELOCITY + Rotation.from_rotvec(-step * rate).apply(arms)
    still = np.zeros_like(points)
    differenced = (stereo.measure(ahead, still, 1.0) - stereo.measure(behind, still, 1.0))[
        :, :2
    ] / (2 * step)
    flow = stereo.measure(points, velocities, 1.0)[:, 4:6]
    np.testing.assert_allclose(flow, differenced, atol=1e-9)
    u, v = stereo.measure(points, velocities, 1.0)[:, :2].T
    one, zero = np.ones_like(u), np.zeros_like(u)
    a = np.moveaxis(np.array([[one, zero, u], [zero, one, v]]), -1, 0)
    b = np.moveaxis(np.array([[-u * v, 1 + u**2, -v], [-1 - v**2, u * v, u]]), -1, 0)
    printed = (a @ VELOCITY) / points[:, 1:2] + b @ rate
    assert np.abs(printed - differenced).max() > least
    assert np.abs(printed - differenced).max() > 5 * np.abs(differenced).max()


def test_disparity_of_equation_28_is_negative():
    shown = stereo.measure(POSITION, VELOCITY, 1.0)
    assert shown[2] - shown[0] == pytest.approx(-1.0 / POSITION[1])
    assert shown[8] < 0


def test_the_leaders_inertia_of_equation_47_is_a_physical_one():
    np.testing.assert_allclose(ratios(INERTIA), [-0.186, -0.0797], atol=5e-4)
    assert 2 * INERTIA.max() < INERTIA.sum()
