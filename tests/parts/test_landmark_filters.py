"""The estimators of pose and shape as a scenario names them, on a short simulated case."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.stats import chi2

from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics.relative_motion import hill_frame
from debrisest.filters.estimates import Estimates
from debrisest.parts.filters.bound import LandmarkBound
from debrisest.parts.filters.landmarks import LandmarkBatch, LandmarkFilter
from debrisest.parts.sensors.camera_range import CameraRange
from debrisest.parts.starts.drawn_shape import DrawnShape
from debrisest.parts.starts.first_image import FirstImage
from debrisest.parts.starts.guess import Guess
from debrisest.parts.truth.closed_ellipse import ClosedEllipse
from debrisest.parts.truth.gravity_gradient import GravityGradient
from debrisest.parts.truth.kepler_orbit import KeplerOrbit
from debrisest.parts.truth.rigid_points import RigidPoints
from debrisest.problems.camera_range.minimal import CameraRangeMinimal
from debrisest.roles import Given

CLOCK = Clock.regular(300.0, 5.0)
WINDOWS = {"windows_s": [50, 100, 200, 900], "spacing_s": [5, 5, 5, 5]}
CORNERS = [[x, y, z] for x in (1, -1) for y in (0.75, -0.75) for z in (0.5, -0.5)]
POINTS = [*CORNERS, [0.35, 2, 0.1], [0, -0.3, 0.9]]


@pytest.fixture(scope="module")
def data():
    parts = [
        RigidPoints(
            kind="rigid_points",
            inertia_kg_m2=[135.4, 208.3, 260.4],
            points={f"p{i}": {"position_m": p, "normal": p} for i, p in enumerate(POINTS)},
        ),
        KeplerOrbit(kind="kepler", semi_major_axis_km=7000.0),
        GravityGradient(kind="gravity_gradient", rate_deg_s=[0.6, 0.4, 1.0]),
        ClosedEllipse(
            kind="closed_ellipse",
            position_m=[5, 17.3205081, 5.90884652],
            velocity_m_s=[9.3358198e-3, -1.078007613e-2, -1.12316e-3],
        ),
        CameraRange(kind="camera_range"),
        DrawnShape(kind="drawn_shape"),
    ]
    draws = Draws(1, "short", range(3))
    found = {"time_s": CLOCK.times}
    for part in parts:
        found |= part.simulate(found, CLOCK, draws)
    return found


def problem(**keys) -> CameraRangeMinimal:
    return CameraRangeMinimal(kind="camera_range_minimal", **keys)


def run(data, chosen, algorithm, start=None):
    start = start or FirstImage(kind="first_image")
    state, covariance = chosen.pack(*start.start(data, CLOCK))
    given = Given(state, covariance, chosen.measurements(data), CLOCK, chosen.truth(data))
    return algorithm.run(chosen.model(data, CLOCK), given)


def assessed(data, chosen, filtered):
    estimated = chosen.unpack(filtered)
    times = {"covariance_time_s": CLOCK.times[filtered.kept], "covariance": filtered.covariance}
    told = {"nis": filtered.nis, "nis_dof": filtered.nis_dof}
    return chosen.assess(data | estimated | times | told | filtered.counts, (0.0, 300.0))


def test_the_truth_is_that_of_the_camera_at_time_zero(data) -> None:
    truth = problem().truth(data)
    to_hill = hill_frame(data["orbit_position"], data["orbit_velocity"])
    body = (
        quaternion.to_matrix(data["true_q_ib"])[:, :, None]
        @ data["true_point_b"][:, None, :, :, None]
    )
    in_hill = (np.swapaxes(to_hill, -1, -2)[:, :, None] @ body)[..., 0]
    points = truth[:, :, 18:].reshape(3, 60, -1, 3)
    found = quaternion.rotate(truth[:, :, None, :4], points)
    np.testing.assert_allclose(found, in_hill, atol=1e-9)
    np.testing.assert_allclose(truth[:, 0, :4], data["true_q_hc"][:, 0], atol=1e-12)


def test_the_first_image_gives_the_direction(data) -> None:
    guess, _ = FirstImage(kind="first_image").start(data, CLOCK)
    position = guess["relative_position_h"]
    np.testing.assert_allclose(
        np.linalg.norm(position, axis=-1), data["measured_range"][:, 0], rtol=1e-12
    )
    error = np.linalg.norm(position - data["chaser_position_h"][:, 0], axis=-1)
    assert (error < 1.0).all()  # m: the middle of the points is not the centre of mass
    drawn, _ = Guess(kind="guess").start(data, CLOCK)
    np.testing.assert_array_equal(guess["rate_b"], drawn["rate_b"])


def test_batch_bound_and_filter_give_errors_in_order(data) -> None:
    batch = LandmarkBatch(kind="landmark_batch", **WINDOWS)
    bound = LandmarkBound(kind="landmark_bound")
    best = run(data, problem(), batch)
    assert best.status.tolist() == ["consistent"] * 3
    assert np.isfinite(best.state).all()
    least = run(data, problem(), bound)
    scores = [assessed(data, problem(), found) for found in (best, least)]
    for name in ("position", "velocity", "rate", "points"):
        ratio = np.median(scores[0][name][:, -1]) / np.median(scores[1][name][:, -1])
        assert 0.3 < ratio < 3.0, name
    sigma = [found.sigma[:, -1, 3:17].mean(0) for found in (best, least)]
    np.testing.assert_allclose(sigma[0], sigma[1], rtol=0.03)
    free = problem(gauge_sigma_deg=5)
    online = assessed(data, free, run(data, free, LandmarkFilter(kind="landmark_filter")))
    assert np.median(online["aligned_points"][:, -1]) < 0.05


def test_the_truth_costs_as_much_more_as_there_are_numbers(data) -> None:
    chosen, batch = problem(), LandmarkBatch(kind="landmark_batch", **WINDOWS)
    counts = run(data, chosen, batch).counts
    assert np.isnan(counts["cost"][:, :-1]).all()
    numbers = counts["cost_numbers"]
    assert numbers.tolist() == [14 + 3 * len(POINTS)] * 3
    excess = (counts["cost_of_truth"] - counts["cost"])[:, -1]
    assert (excess > 0.0).all()
    low, high = chi2.interval(1.0 - 1e-4, numbers.sum())
    assert low < excess.sum() < high
    shifted = data | {"true_rate_b": data["true_rate_b"] + 1e-4}
    wrong = run(shifted, chosen, batch).counts
    assert ((wrong["cost_of_truth"] - wrong["cost"])[:, -1] > chi2.isf(1e-6, numbers)).all()


def test_sigmas_are_named_like_the_estimates(data) -> None:
    chosen = problem(range_to="bias", camera_bias_sigma_deg=0.02)
    short = {"windows_s": [50], "spacing_s": [5], "mirrored": False}
    settings = LandmarkBatch(kind="landmark_batch", restarts=0, **short)
    found = chosen.unpack(run(data, chosen, settings))
    assert found["range_bias"].shape == (3, 60)
    assert found["camera_bias"].shape == found["camera_bias_sigma"].shape == (3, 60, 3)
    assert found["q_hb"].shape[-1] == 4
    for name in ("rate_b", "relative_position_h", "log_inertia", "point_b", "range_bias"):
        assert found[name].shape == found[f"{name}_sigma"].shape


def test_the_sigma_of_a_quaternion_is_that_of_attitudes_so_spread(data) -> None:
    chosen, rng = problem(), np.random.default_rng(0)
    state, covariance = chosen.pack(*FirstImage(kind="first_image").start(data, CLOCK))
    q = quaternion.normalize(rng.standard_normal((3, 4)))
    state[:, :4] = q
    angles = np.array([0.01, 0.02, 0.03])
    sigma = np.zeros(covariance.shape[:-1])
    sigma[:, :3] = angles
    nothing = Estimates(state[:, None], sigma[:, None], covariance, *[np.empty(0)] * 3, np.empty(0))
    found = chosen.unpack(nothing)["q_hb_sigma"][:, 0]
    turns = quaternion.exp(angles * rng.standard_normal((40_000, 1, 3)))
    spread = (quaternion.multiply(q, turns) - q).std(axis=0)
    np.testing.assert_allclose(found, spread, rtol=0.05, atol=3e-4)


def test_constants_of_the_sensors_start_as_told_and_have_a_truth(data) -> None:
    keys = {"range_to": "bias", "range_bias_m": 0.6, "range_bias_sigma_m": 0.2}
    chosen = problem(**keys, camera_bias_sigma_deg=0.05)
    state, covariance = chosen.pack(*FirstImage(kind="first_image").start(data, CLOCK))
    np.testing.assert_array_equal(state[:, 18:22], [[0.6, 0.0, 0.0, 0.0]] * 3)
    sigma = np.sqrt(np.diagonal(covariance, 0, -2, -1))
    np.testing.assert_allclose(sigma[:, 17:21], [[0.2, *np.radians([0.05] * 3)]] * 3)
    turn = np.array([1e-3, -2e-3, 3e-3])
    known = quaternion.multiply(data["true_q_hc"], quaternion.exp(-turn))
    distance = np.linalg.norm(data["chaser_position_h"], axis=-1)
    ranges = distance - np.array([[0.3], [0.7], [0.9]])
    ranges[1, ::2] = np.nan
    truth = chosen.truth(data | {"known_q_hc": known, "measured_range": ranges})
    np.testing.assert_allclose(truth[..., 18], np.repeat([[0.3], [0.7], [0.9]], 60, axis=1))
    np.testing.assert_allclose(truth[..., 19:22] - turn, 0.0, atol=1e-12)


def test_a_bias_of_an_attitude_that_is_implied_is_refused() -> None:
    problem(camera_attitude="implied")
    with pytest.raises(ValidationError, match="camera_bias_sigma_deg is that of a known attitude"):
        problem(camera_attitude="implied", camera_bias_sigma_deg=0.02)


def test_what_cannot_be_measured_is_refused_in_words(data) -> None:
    zero = data["measured_range"].copy()
    zero[1, 2] = 0.0
    with pytest.raises(ValueError, match="range at 10 s is zero or negative"):
        problem().measurements(data | {"measured_range": zero})
    held = data | {"landmark_range": -data["landmark_range"]}
    with pytest.raises(ValueError, match="range at 0 s is zero or negative"):
        problem(range_to="landmark").measurements(held)
    with pytest.raises(ValueError, match="at least 4 points, 3 were tracked"):
        problem().measurements(data | {"measured_pixel": data["measured_pixel"][..., :3, :]})
    with pytest.raises(ValueError, match="no image shows any point"):
        problem().measurements(
            data | {"measured_pixel": np.full_like(data["measured_pixel"], np.nan)}
        )


def test_nothing_is_told_of_ratios_that_were_known_better_before(data) -> None:
    chosen = problem(log_inertia_sigma=1e-4)
    found = assessed(data, chosen, run(data, chosen, LandmarkBound(kind="landmark_bound")))
    assert found["unobservable_ratios"].tolist() == [5.0] * 3


def test_a_frame_without_a_ranged_point_has_no_range(data) -> None:
    landmark, ranges = data["landmark"].copy(), data["landmark_range"].copy()
    landmark[:, 5], ranges[:, 5] = np.nan, np.nan
    chosen = problem(range_to="landmark")
    found = chosen.measurements(data | {"landmark": landmark, "landmark_range": ranges})
    count = np.isfinite(found.reshape(3, 60, -1, 3)[..., 2]).sum(-1)
    assert (count[:, 5] == 0).all()
    assert (np.delete(count, 5, axis=1) == 1).all()


def test_a_run_that_does_not_fit_says_so(data) -> None:
    surface = data | {"measured_range": data["measured_range"] - 1.0}
    settings = {"windows_s": [50, 100, 150], "spacing_s": [5, 5, 5]}
    batch = LandmarkBatch(kind="landmark_batch", restarts=0, mirrored=False, **settings)
    wild = surface["measured_pixel"].copy()
    wild[:, 40:] += 4.0 * np.random.default_rng(0).normal(size=wild[:, 40:].shape)
    status = run(surface | {"measured_pixel": wild}, problem(), batch).status
    assert all("larger than stated" in words or "lost" in words for words in status)


def test_a_bound_whose_model_leaves_the_truth_is_told_and_not_printed(data) -> None:
    """A true attitude that jumps is no motion of this model."""
    chosen = problem()
    truth = chosen.truth(data).copy()
    truth[1, 10:, :4] = quaternion.multiply(
        truth[1, 10:, :4], quaternion.exp(np.array([0.05, 0.0, 0.0]))
    )
    state, covariance = chosen.pack(*FirstImage(kind="first_image").start(data, CLOCK))
    given = Given(state, covariance, chosen.measurements(data), CLOCK, truth)
    found = LandmarkBound(kind="landmark_bound").run(chosen.model(data, CLOCK), given)
    assert found.status[1].startswith("lost: no bound")
    assert np.isnan(found.state[1]).all()
    assert found.status[[0, 2]].tolist() == ["linearised at the truth"] * 2
    assert np.isfinite(found.state[[0, 2]]).all()


def test_a_batch_of_which_every_run_is_lost_says_so(data) -> None:
    wild = data | {"measured_pixel": 1e6 * data["measured_pixel"]}
    batch = LandmarkBatch(kind="landmark_batch", restarts=1, **WINDOWS)
    found = run(wild, problem(), batch)
    assert (found.counts["doubt"] == 3).all()


def test_noise_that_is_larger_than_said_is_told(data) -> None:
    quieter = data | {"pixel_noise": 0.8 * data["pixel_noise"]}
    status = run(quieter, problem(), LandmarkBatch(kind="landmark_batch", **WINDOWS)).status
    assert all("the cost at the estimate" in words for words in status)


def test_the_bound_needs_a_truth(data) -> None:
    chosen = problem()
    state, covariance = chosen.pack(*Guess(kind="guess").start(data, CLOCK))
    given = Given(state, covariance, chosen.measurements(data), CLOCK)
    with pytest.raises(ValueError, match="linearised at the truth"):
        LandmarkBound(kind="landmark_bound").run(chosen.model(data, CLOCK), given)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"windows_s": [50, 100]}, "as many entries"),
        ({"windows_s": [], "spacing_s": []}, "at least one"),
        ({"windows_s": [100, 50], "spacing_s": [5, 5]}, "must grow"),
        ({"windows_s": [50], "spacing_s": [60]}, "spacing of 60 s exceeds its window of 50 s"),
        ({"windows_s": [50], "spacing_s": [15]}, "fewer than 5 frames"),
    ],
)
def test_windows_that_make_no_sense(keys: dict, words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        LandmarkBatch(kind="landmark_batch", **keys)


def test_a_run_with_too_few_landmarks_says_so(data) -> None:
    hidden = data["measured_pixel"].copy()
    hidden[..., 3:, :] = np.nan
    settings = {"windows_s": [50, 100, 150], "spacing_s": [5, 5, 5]}
    batch = LandmarkBatch(kind="landmark_batch", **settings)
    status = run(data | {"measured_pixel": hidden}, problem(), batch).status
    assert all("fewer than 4 landmarks" in words for words in status)
