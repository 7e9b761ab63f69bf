"""The pixel's motion against a camera that is turned, and the law against its printed matrices."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from debrisest.control.pixel_motion import curvature, rate_matrix
from debrisest.control.pixel_tracking import GAINS, track_pixel
from debrisest.control.rigid_spacecraft import spacecraft
from debrisest.control.robust_term import Uncertainty

SCALE = 335.0
seeds = st.integers(0, 10**6)


def seen(pixel: np.ndarray, rotation: Rotation) -> np.ndarray:
    """Pixel, after the body has turned, of what had the first pixel; the camera looks along -y."""
    x, y = pixel / SCALE
    x, up, ahead = rotation.inv().apply([x, -1.0, y]) * [1.0, 1.0, -1.0]
    return SCALE * np.array([x, -ahead]) / -up


def case(seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.uniform([-240, -180], [240, 180]), rng.normal(size=3)


@given(seeds)
def test_rate_and_curvature_of_a_pixel_match_a_turned_camera(seed: int) -> None:
    pixel, rate = case(seed)
    step = 1e-4
    behind, ahead = (seen(pixel, Rotation.from_rotvec(s * step * rate)) for s in (-1, 1))
    pixel_rate = rate_matrix(pixel, SCALE) @ rate
    scale = SCALE * (1.0 + np.abs(rate).max()) ** 2
    np.testing.assert_allclose(pixel_rate, (ahead - behind) / (2 * step), atol=1e-5 * scale)
    bent = curvature(pixel, pixel_rate, rate, SCALE)
    np.testing.assert_allclose(bent, (ahead - 2 * pixel + behind) / step**2, atol=1e-4 * scale)


def test_the_rate_matrix_matches_differences_to_a_millionth() -> None:
    for pixel in ([0.0, 0.0], [228.9, -42.8], [-100.0, 170.0]):
        step, at = 1e-5, np.array(pixel)
        turns = [[Rotation.from_rotvec(s * step * e) for s in (1, -1)] for e in np.eye(3)]
        differenced = [(seen(at, a) - seen(at, b)) / (2 * step) for a, b in turns]
        expected = np.stack(differenced, axis=-1)
        assert np.abs(rate_matrix(at, SCALE) - expected).max() < 1e-6 * np.abs(expected).max()


@settings(max_examples=30)
@given(seed=seeds)
def test_torque_is_the_least_squares_solution_of_the_papers_equation(seed, inertia) -> None:
    """Without the robust term: pixels and rates then have the wanted second and first derivative.

    What the outputs do at a torque is differenced along the turning body.
    """
    pixel, rate = case(seed)
    demand = track_pixel(
        *(spacecraft(inertia), GAINS, Uncertainty(), "none"),
        *(pixel, rate, np.zeros(5), SCALE),
    )

    def outputs(torque: np.ndarray) -> np.ndarray:
        spin_up = np.linalg.solve(inertia, torque - np.cross(rate, inertia @ rate))
        h = 1e-4
        turns = [Rotation.from_rotvec(s * h * rate + 0.5 * h**2 * spin_up) for s in (1, -1)]
        ahead, behind = (seen(pixel, turn) for turn in turns)
        return np.concatenate([(ahead - 2 * pixel + behind) / h**2, spin_up])

    drift = outputs(np.zeros(3))
    input_matrix = np.stack([(outputs(1e-3 * e) - drift) / 1e-3 for e in np.eye(3)], axis=-1)
    h = 1e-6
    pixel_rate = (seen(pixel, Rotation.from_rotvec(h * rate)) - pixel) / h
    wanted = np.concatenate([-5.0 * pixel - 3.0 * pixel_rate, -rate])
    expected = np.linalg.lstsq(input_matrix, wanted - drift, rcond=None)[0]
    np.testing.assert_allclose(demand.torque, expected, atol=2e-3 * np.abs(expected).max())


def test_at_the_goal_there_is_no_torque(inertia) -> None:
    demand = track_pixel(
        *(spacecraft(inertia), GAINS, Uncertainty(), "literal"),
        *(np.zeros(2), np.zeros(3), np.zeros(5), SCALE),
    )
    np.testing.assert_array_equal(demand.torque, 0.0)
