"""The bound of tracked points against an independent one, and its errors against chi-square."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.assessment.consistency import interval, normalized_square
from debrisest.clock import Clock
from debrisest.filters.bound.motion import paired_errors
from debrisest.parts.filters.bound import Efficient
from debrisest.parts.starts.first_points import FirstPoints
from debrisest.problems.tumbling.points import MotionVariances, TumblingPoints
from debrisest.problems.tumbling.points_inertia import log_tensor
from debrisest.roles import Given

# in their own frame: x from the first to the second, y normal to the first three
POINTS = np.array([[0, 0, 0], [2, 0, 0], [0.5, 0, -1], [-1, 2, 0.3], [0.2, -1, 2], [1, 1, 1.0]])
NOISE, EPOCHS = 0.002, 60
CLOCK = Clock.regular(float(EPOCHS), 1.0)
VARIANCE = MotionVariances(attitude_rad2=1, rate_rad2_s2=0.1, log_inertia=1)
PROBLEM = TumblingPoints(kind="tumbling_points")
START = FirstPoints(kind="first_points", variance=VARIANCE)
TRUTH = np.array([0.5, -0.1, 0.7, 0.5, 0.1, 0.08, -0.12, 0.2, -0.15, 0.1, -0.05, 0.08, 0.0])
# the frame of the features is turned and moved against the body's axes
R_BF = Rotation.from_rotvec([0.3, -0.5, 0.9])


def experiment(runs, seed, integrated):
    """Datasets of a body whose points are hidden at random, at translations of no model."""
    rng = np.random.default_rng(seed)
    start = TRUTH.copy()
    start[:4] /= np.linalg.norm(start[:4])
    (matrix,), (rate,) = integrated(start[None], CLOCK.times)
    inertia = R_BF.as_matrix() @ tensor(start) @ R_BF.as_matrix().T
    shape = (runs, EPOCHS, len(POINTS))
    shown = POINTS @ np.swapaxes(matrix, -1, -2) + 10 * rng.normal(size=(runs, EPOCHS, 1, 3))
    shown = shown + NOISE * rng.normal(size=shown.shape)
    shown[rng.random(shape) > 0.7] = np.nan
    q_ib = (Rotation.from_matrix(matrix) * R_BF.inv()).as_quat(scalar_first=True)
    each = {
        "true_q_ib": q_ib,
        "true_rate_b": R_BF.apply(rate),
        "true_inertia_b": 12.0 * inertia,
        "true_point_b": POINTS @ R_BF.as_matrix().T + [0.3, 0.2, 0.1],
        "known_point_f": POINTS,
    }
    data = {name: np.broadcast_to(value, (runs, *value.shape)) for name, value in each.items()}
    noise = np.full(runs, NOISE)
    return start, data | {"measured_point": shown, "point_noise": noise, "time_s": CLOCK.times}


def tensor(state):
    values, axes = np.linalg.eigh(log_tensor(state[7:12]))
    return (axes * np.exp(values)) @ axes.T


def assert_consistent(squares, freedom):
    low, high = interval(np.array(freedom * len(squares)), 0.9999)
    assert low < squares.mean() / freedom < high


def given(data):
    state, covariance = PROBLEM.pack(*START.start(data, CLOCK))
    return Given(state, covariance, PROBLEM.measurements(data), CLOCK, PROBLEM.truth(data))


@pytest.fixture(scope="module")
def runs(integrated):
    start, data = experiment(150, 0, integrated)
    given_ = given(data)
    model = PROBLEM.model(data, CLOCK)
    first = given_.truth[:, 0], given_.state, given_.covariance[0]
    return start, data, paired_errors(model, *first, given_.measured, [0, EPOCHS - 1])


def test_the_truth_is_in_the_features_own_axes(runs):
    start, data, _ = runs
    truth = PROBLEM.truth(data)
    turn = (
        Rotation.from_quat(truth[0, 0, :4], scalar_first=True)
        * Rotation.from_quat(start[:4], scalar_first=True).inv()
    )
    assert turn.magnitude() < 1e-12
    np.testing.assert_allclose(truth[5, 0, 4:12], start[4:12], rtol=0, atol=1e-12)


def test_the_information_is_that_of_the_attitude_of_each_epoch(runs, integrated, nudged):
    """An epoch tells ``tr(F) I - F`` of the turn, F of the seen points about their mean."""
    start, data, errors = runs
    turn = np.zeros((EPOCHS, 3, 11))
    turn[:, :, :3] = np.eye(3)
    moved = [nudged(start, index, s * 1e-5) for s in (1, -1) for index in range(3, 11)]
    ends, _ = integrated(np.array([*moved, start]), CLOCK.times)
    for index in range(8):
        relative = Rotation.from_matrix(ends[index] @ ends[index + 8].swapaxes(-1, -2))
        turn[:, :, index + 3] = relative.as_rotvec() / 2e-5
    matrix = ends[-1]
    for run in (0, 7):
        blocks = (VARIANCE.attitude_rad2, VARIANCE.rate_rad2_s2, VARIANCE.log_inertia)
        information = np.diag(1 / np.repeat(blocks, (3, 3, 5)))
        for k in range(EPOCHS):
            seen = POINTS[~np.isnan(data["measured_point"][run, k, :, 0])] @ matrix[k].T
            if len(seen):
                centred = seen - seen.mean(axis=0)
                spread = centred.T @ centred
                block = np.trace(spread) * np.eye(3) - spread
                information += turn[k].T @ block @ turn[k] / NOISE**2
        found = errors.smoother_covariance[run, 0] @ information
        np.testing.assert_allclose(found, np.eye(11), rtol=0, atol=1e-4)


def test_errors_are_as_large_as_the_bound_says(runs):
    *_, errors = runs
    for error, covariance in (
        (errors.smoother_error[:, [0, -1]], errors.smoother_covariance),
        (errors.filter_error[:, [-1]], errors.filter_covariance[:, [-1]]),
    ):
        for k in range(error.shape[1]):
            assert_consistent(normalized_square(error[:, k], covariance[:, k]), 11)


def test_the_guess_carries_practically_no_information(runs):
    _, data, errors = runs
    given_ = given(data)
    wide = 100.0 * given_.covariance[0]
    first = given_.truth[:, 0], given_.state, wide
    again = paired_errors(PROBLEM.model(data, CLOCK), *first, given_.measured, [0])
    np.testing.assert_allclose(again.smoother_sigma, errors.smoother_sigma, rtol=0.02)


def test_translations_drop_out(runs):
    _, data, _ = runs
    moved = data["measured_point"] + np.linspace(-30, 50, EPOCHS)[:, None, None]
    rows = PROBLEM.measurements(data | {"measured_point": moved})
    np.testing.assert_allclose(rows, PROBLEM.measurements(data), rtol=0, atol=1e-12)


@pytest.mark.parametrize("smoother", [False, True])
def test_the_bound_scores_as_an_estimator(runs, smoother):
    """Scored in principal axes; the normalised error squared of the rate has three dimensions."""
    _, data, _ = runs
    efficient = Efficient(kind="efficient", smoother=smoother, keep_s=[40.0, 55.0])
    found = efficient.run(PROBLEM.model(data, CLOCK), given(data))
    kept = {
        "covariance": found.covariance,
        "covariance_time_s": CLOCK.times[found.kept],
    }
    scores = PROBLEM.assess(data | PROBLEM.unpack(found) | kept, (40.0, 60.0))
    times = np.isfinite(scores["nees"][0]).nonzero()[0]
    assert times.tolist() == [40, 55, EPOCHS - 1]
    for k in times:
        assert_consistent(3 * scores["nees"][:, k], 3)
        norm = np.linalg.norm([scores[f"rate_{i}"][:, k] for i in (1, 2, 3)], axis=0)
        np.testing.assert_allclose(norm, scores["rate"][:, k])


def test_points_without_noise_are_refused(runs):
    _, data, _ = runs
    with pytest.raises(ValueError, match="must be positive"):
        PROBLEM.model(data | {"point_noise": np.zeros(150)}, CLOCK)


@pytest.mark.parametrize("hidden", [0, 3])
def test_the_guess_of_a_steady_spin(hidden):
    """The first epochs may have no attitude; a body that does not nutate is guessed exactly."""
    times, rate = CLOCK.times, np.array([0.02, -0.05, 0.03])
    first = Rotation.from_rotvec([0.4, 0.1, -0.9])
    turn = first * Rotation.from_rotvec(np.outer(times, rate))
    shown = np.array([each.apply(POINTS) for each in turn])[None]
    shown[:, :hidden, 2:] = np.nan
    data = {"measured_point": shown, "known_point_f": POINTS[None]}
    guess, variance = START.start(data, CLOCK)
    np.testing.assert_allclose(guess["rate_f"][0], rate, atol=1e-12)
    start = Rotation.from_quat(guess["q_if"][0], scalar_first=True)
    assert (start * first.inv()).magnitude() < 1e-12
    assert [float(each[0, 0]) for each in variance.values()] == [*VARIANCE.model_dump().values()]


def test_a_run_without_attitude_has_no_guess():
    shown = np.full((2, EPOCHS, len(POINTS), 3), np.nan)
    shown[1] = POINTS
    data = {"measured_point": shown, "known_point_f": np.tile(POINTS, (2, 1, 1))}
    guess, _ = START.start(data, CLOCK)
    assert np.isnan(guess["q_if"][0]).all() and np.isnan(guess["rate_f"][0]).all()
    assert np.isfinite(guess["q_if"][1]).all() and np.isfinite(guess["rate_f"][1]).all()
