"""What an estimator takes noises and first guesses for may differ from what they are."""

import numpy as np
import pytest

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.parts.starts.drawn_orbit import DrawnOrbit
from debrisest.parts.starts.guess import Guess
from debrisest.problems.camera_range.minimal import CameraRangeMinimal
from debrisest.problems.camera_range.redundant import CameraRangeRedundant
from debrisest.problems.camera_range.redundant_model import CORE, RATE, VELOCITY
from debrisest.problems.stereo_pose.problem import StereoPose, StereoPoseAdditive

CLOCK = Clock.regular(10.0, 5.0)
ORBIT = {
    "orbit_position": np.tile([7e6, 0.0, 0.0], (1, 2, 1)),
    "orbit_velocity": np.tile([0.0, np.sqrt(3.986004418e14 / 7e6), 0.0], (1, 2, 1)),
}
CAMERA = ORBIT | {
    "measured_pixel": np.zeros((1, 2, 1, 4, 2)),
    "measured_range": np.ones((1, 2)),
    "known_q_hc": np.tile([1.0, 0, 0, 0], (1, 2, 1)),
    "focal_px": np.array([1e3]),
    "pixel_noise": np.array([1.04]),
    "range_noise": np.array([0.01]),
    "attitude_noise": np.zeros(1),
}
STEREO = ORBIT | {
    "measured_pixel": np.zeros((1, 2, 2, 5, 2)),
    "measured_disparity": np.zeros((1, 2, 5)),
    "measured_angular_acceleration": np.zeros((1, 2, 3)),
    "angular_acceleration_noise": np.array([1e-6]),
    "baseline": np.ones(1),
    "focal_px": np.array([800.0]),
    "pixel_noise": np.array([0.5]),
    "disparity_noise": np.array([0.7]),
    "start_point_b": np.zeros((1, 5, 3)),
}
SIGMAS = {"position": 3, "velocity": 3, "rate_l": 3, "q_lt": 4, "inertia_ratio": 2}
STEREO |= {f"start_{name}_sigma": np.ones((1, size)) for name, size in SIGMAS.items()}
STEREO |= {"start_point_b_sigma": np.ones((1, 5, 3))}


def test_noises_of_the_published_filter_are_keys() -> None:
    kind = "camera_range_redundant"
    simulated = CameraRangeRedundant(kind=kind).model(CAMERA, CLOCK)
    assert np.diag(simulated.measurement_noise) == pytest.approx([1.04**2] * 8 + [1e-4])
    assert not simulated.process_noise.any()
    thought = CameraRangeRedundant.model_validate(
        {"kind": kind, "pixel_noise_px": 3.0, "range_noise_m": 0.5}
        | {"process_noise": {"velocity_m_s": 1e-3, "rate_rad_s": 1e-4}}
    ).model(CAMERA, CLOCK)
    assert np.diag(thought.measurement_noise) == pytest.approx([9.0] * 8 + [0.25])
    expected = np.zeros(CORE + 24)
    expected[VELOCITY], expected[RATE] = 1e-6, 1e-8
    assert thought.process_noise == pytest.approx(np.diag(expected))


def test_the_pixels_noise_of_the_minimal_problem_is_a_key() -> None:
    kind = "camera_range_minimal"
    usual = CameraRangeMinimal(kind=kind).model(CAMERA, CLOCK)
    thought = CameraRangeMinimal(kind=kind, pixel_noise_px=10.4).model(CAMERA, CLOCK)
    assert thought.sigma == pytest.approx(10 * usual.sigma)


@pytest.mark.parametrize("problem", [StereoPose, StereoPoseAdditive])
def test_noises_of_the_stereo_problem_are_keys(problem: type) -> None:
    """Rows of a point: four pixels and a disparity, slopes; then three accelerations."""

    def sigma(**keys: float) -> np.ndarray:
        kind = problem.model_fields["kind"].annotation.__args__[0]
        model = problem(kind=kind, **keys).model(STEREO, CLOCK)
        if problem is StereoPose:
            return np.asarray(model.sigma)
        return np.sqrt(np.diag(model.measurement_noise))

    point = [0.5 / 800] * 4 + [0.7 / 800]
    assert sigma() == pytest.approx(point * 5 + [1e-6] * 3)
    thought = sigma(pixel_noise_px=8.0, acceleration_noise_rad_s2=1e-3)
    assert thought == pytest.approx(([1e-2] * 4 + [0.7 / 800]) * 5 + [1e-3] * 3)


def test_a_first_guess_may_be_taken_for_better_than_it_is() -> None:
    data = {"start_rate_b": np.ones((2, 3)), "start_rate_b_sigma": np.full((2, 3), 0.3)}
    data |= {"start_point_b": np.ones((2, 4, 3)), "start_point_b_sigma": np.ones((2, 4, 3))}
    guess, variance = Guess(kind="guess", sigma_factors={"rate_b": 0.1}).start(data, CLOCK)
    assert (guess["rate_b"] == 1.0).all()
    assert variance["rate_b"] == pytest.approx(np.full((2, 3), 9e-4))
    assert (variance["point_b"] == 1.0).all()
    with pytest.raises(ValueError, match=r"no first guess of speed; there are point_b, rate_b"):
        Guess(kind="guess", sigma_factors={"speed": 2.0}).start(data, CLOCK)


def test_a_first_guess_has_a_sigma_for_each_axis() -> None:
    runs, sigma = 4000, np.array([100.0, 10.0, 1.0])
    data = {name: np.repeat(orbit, runs, axis=0) for name, orbit in ORBIT.items()}
    drawn = DrawnOrbit(kind="drawn_orbit", position_sigma_m=list(sigma), velocity_sigma_m_s=2.0)
    start = drawn.simulate(data, CLOCK, Draws(1, "case", range(runs)))
    error = start["start_orbit_position"] - data["orbit_position"][:, 0]
    bound = 5 / np.sqrt(2 * runs)
    assert error.std(axis=0) / sigma == pytest.approx(np.ones(3), abs=bound)
    assert (start["start_orbit_position_sigma"] == sigma).all()
    assert (start["start_orbit_velocity_sigma"] == 2.0).all()
