"""Motion and observed: against a simulation by other formulas, and derivatives by differences."""

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.problems.camera_range.projection import landmark_model

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
        np.testing.assert_allclose(rows.by_core[..., k], (up.shown - down.shown) / 2e-6, atol=1e-5)
        common = (up.common - down.common) / 2e-6
        np.testing.assert_allclose(rows.common_by_core[..., k], common, atol=1e-7)
    for k, step in enumerate(1e-6 * np.eye(3)):
        up, down = (model.rows(cores, points + s, epochs).shown for s in (step, -step))
        np.testing.assert_allclose(rows.by_point[..., k], (up - down) / 2e-6, atol=1e-5)


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
