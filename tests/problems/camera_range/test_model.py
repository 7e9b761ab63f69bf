"""Motion and observed: against a simulation by other formulas, and derivatives by differences."""

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.dynamics import clohessy_wiltshire
from debrisest.problems.camera_range.doubts import doubtful_model
from debrisest.problems.camera_range.projection import landmark_model

N, STEP = 1.078007613e-3, 5.0

CASES = {
    "known": {},
    "implied": {"attitude": "implied"},
    "bias": {"range_to": "bias", "camera_bias": True},
    "landmark": {"range_to": "landmark"},
    "implied-landmark": {"attitude": "implied", "range_to": "landmark"},
}


@pytest.fixture(scope="module", params=CASES)
def case(request, experiment):
    return experiment(2, 12, 0, noise=0.0, **CASES[request.param])


def test_the_truth_shows_what_was_simulated(case) -> None:
    if case.known.camera_bias:
        case.core[..., -3:] = 0.0
    cores, _ = case.model.trajectory(case.core[:, 0], 11)
    rows = case.model.rows(cores, case.points[:, None], np.arange(12))
    observed = case.observed
    difference = np.where(observed.seen, observed.shown - rows.shown, 0.0)
    np.testing.assert_allclose(difference, 0.0, atol=1e-3)
    np.testing.assert_allclose(observed.common, rows.common, atol=1e-9)


def test_derivatives_of_the_rows(case) -> None:
    model, cores = case.model, case.core
    points, epochs = case.points[:, None], np.arange(12)
    rows = model.rows(cores, points, epochs)
    for k, step in enumerate(1e-6 * np.eye(model.errors)):
        error = np.broadcast_to(step, (*cores.shape[:2], model.errors))
        up = model.rows(model.retract(cores, error), points, epochs)
        down = model.rows(model.retract(cores, -error), points, epochs)
        by_core, common_by_core = _whole(model, rows.by_core), _whole(model, rows.common_by_core)
        np.testing.assert_allclose(by_core[..., k], (up.shown - down.shown) / 2e-6, atol=1e-5)
        common = (up.common - down.common) / 2e-6
        np.testing.assert_allclose(common_by_core[..., k], common, atol=1e-7)
    for k, step in enumerate(1e-6 * np.eye(3)):
        up, down = (model.rows(cores, points + s, epochs).shown for s in (step, -step))
        np.testing.assert_allclose(rows.by_point[..., k], (up - down) / 2e-6, atol=1e-5)


def _whole(model, by_core):
    """Derivative by all errors of the core."""
    whole = np.zeros((*by_core.shape[:-1], model.errors))
    whole[..., model.shown_by] = by_core
    return whole


def test_derivatives_of_the_places(case) -> None:
    model, epochs = case.model, np.full((2, len(case.points[0])), 5)
    cores = np.repeat(case.core[:, 5:6], epochs.shape[1], axis=1)
    shown = case.observed.shown[:, 5]
    points, by_core, _ = model.place(cores, shown, epochs)
    for k, step in enumerate(1e-6 * np.eye(model.errors)):
        error = np.broadcast_to(step, (*cores.shape[:2], model.errors))
        up, down = (model.place(model.retract(cores, e), shown, epochs)[0] for e in (error, -error))
        np.testing.assert_allclose(by_core[..., k], (up - down) / 2e-6, atol=1e-7)
    again = model.rows(case.core[:, 5:6], points[:, None], np.array([5])).shown[:, 0, :, :2]
    np.testing.assert_allclose(again, shown[..., :2], atol=1e-9)


def test_the_start_is_the_cameras_attitude_with_its_derivative(case) -> None:
    model = case.model
    parameters = model.parameters(case.core[:, 0])
    core, derivative = model.start(parameters)
    np.testing.assert_allclose(core, case.core[:, 0], atol=1e-12)
    for k, step in enumerate(1e-6 * np.eye(parameters.shape[-1])):
        up, down = (model.start(parameters + s)[0] for s in (step, -step))
        np.testing.assert_allclose(derivative[..., k], model.difference(up, down) / 2e-6, atol=1e-8)


def test_transitions_against_differences_of_trajectories(case) -> None:
    model, start = case.model, case.core[:, 0]
    cores, transitions = model.trajectory(start, 11)
    one, step = model.process(start)
    np.testing.assert_allclose(one, cores[:, 1], atol=1e-12)
    np.testing.assert_allclose(step, transitions[:, 1], atol=1e-12)
    rng = np.random.default_rng(0)
    error = 1e-6 * rng.normal(size=(2, model.errors))
    up, down = (model.trajectory(model.retract(start, e), 11)[0] for e in (error, -error))
    found = (transitions @ error[:, None, :, None])[..., 0]
    np.testing.assert_allclose(found, model.difference(up, down) / 2, atol=2e-10)


def test_an_infinitely_distant_camera_cannot_tell_the_mirror(experiment) -> None:
    """Along the axes of the first image, without the Earth: depth and nothing else differs."""
    case = experiment(1, 2, 0, noise=0.0)
    model = landmark_model(case.known._replace(mean_motion=1e-9))
    parameters, points = model.parameters(case.core[:, 0]), case.points
    seen = []
    for x, p in ((parameters, points), model.mirror(parameters, points)):
        cores, _ = model.trajectory(model.start(x)[0], 100)
        turn = np.swapaxes(case.known.camera[0, 0], -1, -2) @ quaternion.to_matrix(cores[0, :, :4])
        seen.append(p[0] @ np.swapaxes(turn, -1, -2))
    np.testing.assert_allclose(seen[0] * [1.0, 1.0, -1.0], seen[1], atol=1e-5)


def test_a_fast_rotation_is_taken_in_smaller_steps(experiment) -> None:
    """At 6 deg/s one Runge-Kutta step in 5 s is 2 deg off after ten minutes."""
    case = experiment(1, 121, 40, rate_deg_s=(3.0, -2.0, 5.0), noise=0.0)
    cores, _ = case.model.trajectory(case.core[:, 0], 120)
    apart = case.model.difference(cores[:, -1], case.core[:, -1])[0]
    assert np.degrees(np.abs(apart[:3]).max()) < 0.02
    assert np.degrees(np.abs(apart[3:6]).max()) < 1e-3
    slow = case.core[:, 0].copy()
    slow[:, 4:7] *= 0.1
    alone, _ = case.model.trajectory(slow, 20)
    pair = case.model.of(np.array([0, 0]))
    both, _ = pair.trajectory(np.concatenate([slow, case.core[:, 0]]), 20)
    np.testing.assert_array_equal(both[:1], alone)


def test_doubts_are_the_slopes_of_what_is_shown(experiment) -> None:
    """Derivatives by a focal length, a range, a turned camera and a push against differences."""
    case = experiment(1, 41, 41, noise=0.0)
    known = case.known
    wide = doubtful_model(known).doubted()
    parameters = np.insert(case.model.parameters(case.core[:, 0]), [14] * 11, 0.0, axis=-1)
    epoch = np.array([40])
    cores, by_start, _ = wide.course(parameters, epoch)
    rows = wide.rows(cores, case.points[:, None], epoch)
    by_end = by_start(slice(1))[:, 0, :, 14:]
    pixels = (rows.by_core[0, 0] @ by_end[0])[..., :2, :]

    def shown(model, core=None):
        at = cores if core is None else core
        return model.rows(at, case.points[:, None], epoch).shown[0, 0, :, :2]

    base = shown(case.model)
    longer = landmark_model(known._replace(focal=known.focal * (1 + 1e-6)))
    np.testing.assert_allclose(pixels[..., 0], (shown(longer) - base) / 1e-6, rtol=1e-3)
    turned = known.camera @ quaternion.to_matrix(quaternion.exp(np.array([1e-6, 0.0, 0.0])))
    other = landmark_model(known._replace(camera=turned))
    np.testing.assert_allclose(pixels[..., 2], (shown(other) - base) / 1e-6, rtol=1e-3, atol=1e-2)
    assert (rows.common_by_core[0, 0, 0, 6:] == np.eye(11)[1]).all()
    times = STEP * np.arange(41.0)
    pushed, _ = clohessy_wiltshire.propagate(np.zeros(3), np.zeros(3), N, times)
    for axis in range(3):
        push = np.eye(3)[axis]
        for start in times[:-1]:
            kick, drift = push * STEP, 0.5 * push * STEP**2
            rest = np.array([times[-1] - start - STEP])
            pushed[-1] += clohessy_wiltshire.propagate(drift, kick, N, rest)[0][0]
        np.testing.assert_allclose(by_end[0, 3:6, 5 + axis], pushed[-1], rtol=1e-9)
        pushed[-1] = 0.0


def test_noise_of_the_attitude_does_not_look_like_another_focal_length(experiment) -> None:
    """Its score is zero in the mean, though pixels and residuals have the same noise in them."""
    draws, epoch, sigma = 4000, np.array([40]), 3.5e-4
    case = experiment(1, 41, 41, noise=0.0)
    turn = sigma * np.random.default_rng(9).normal(size=(draws, 1, 3))
    noisy = case.known.camera[:, epoch] @ quaternion.to_matrix(quaternion.exp(turn))
    known = case.known._replace(camera=noisy, attitude_sigma=sigma)
    model = doubtful_model(known).doubted()
    core = np.concatenate([case.core[0, epoch], np.zeros((1, len(model.doubts)))], axis=-1)
    rows = model.rows(np.broadcast_to(core, (draws, 1, core.shape[-1])), case.points[:, None], [0])
    seen = case.model.rows(case.core[:, epoch], case.points[:, None], epoch).shown[0, 0]
    residual = (seen - rows.shown[:, 0]).reshape(draws, -1)
    shared = rows.shared[0, 0].reshape(residual.shape[1], -1)
    left = residual @ np.linalg.inv(np.eye(len(shared)) + shared @ shared.T)
    by_focal = rows.by_core[:, 0, :, :, 6].reshape(draws, -1)
    plain = rows.shown[:, 0].reshape(draws, -1)
    by_noise = shared.T @ shared
    expected = -np.trace(np.linalg.solve(np.eye(3) + by_noise, by_noise))
    assert (plain * left).sum(-1).mean() == pytest.approx(expected, rel=0.1)
    assert abs((by_focal * left).sum(-1).mean()) < 0.01 * abs(expected)
    assert np.linalg.norm(by_focal[0]) > 0.8 * np.linalg.norm(plain[0] - plain[0].mean())
