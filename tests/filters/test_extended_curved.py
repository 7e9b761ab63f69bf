"""States whose errors live in another space."""

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.filters.kalman.extended import extended
from debrisest.filters.model import Model
from tests.filters.circle import ANGLE, CIRCLE, either_sign, on_circle, projecting, turning

TANGENT = CIRCLE._replace(
    process_jacobian=lambda x, _: np.array([[1.0, 1.0], [0.0, 1.0]]),
    measurement_jacobian=lambda x, _: np.stack(
        [np.stack([-x[..., 1], x[..., 0]], axis=-1), np.zeros_like(x[..., :2])], axis=-1
    ),
)


@pytest.mark.parametrize("iterations", [1, 10])
@pytest.mark.parametrize("circle", [CIRCLE, TANGENT])
def test_circle_equals_angle(circle, iterations):
    """State (cos, sin, rate) with errors (angle, rate), against the state (angle, rate)."""
    rate, start, covariance, y = turning()
    rule = {"iterations": iterations, "tolerance": 1e-12}

    flat = extended(ANGLE, start, covariance, y, **rule)
    curved = extended(circle, on_circle(start), covariance, y, **rule)
    np.testing.assert_allclose(curved.state, on_circle(flat.state), atol=1e-7)
    np.testing.assert_allclose(curved.covariance, flat.covariance, atol=1e-8)
    np.testing.assert_allclose(curved.nis, flat.nis, atol=1e-6)
    assert np.abs(flat.state[:, -1, 1] - rate).max() < 0.1


def test_attitude_from_directions_is_the_most_probable_one():
    """Quaternions with left rotation errors: the posterior's gradient, by differences, is zero."""
    rng = np.random.default_rng(1)
    sigma, noise = 0.3, 0.02
    directions = rng.normal(size=(3, 3))

    def shown(q, _):
        return quaternion.rotate(q[..., None, :], directions).reshape(*q.shape[:-1], 9)

    model = Model(
        process=lambda q, _: q,
        measurement=shown,
        process_noise=np.zeros((3, 3)),
        measurement_noise=noise**2 * np.eye(9),
        error_names=("1", "2", "3"),
        retract=lambda q, e: quaternion.multiply(quaternion.exp(e), q),
        difference=lambda p, q: quaternion.log(quaternion.multiply(p, quaternion.conjugate(q))),
    )
    start = quaternion.normalize(rng.normal(size=(20, 4)))
    truth = model.retract(start, sigma * rng.normal(size=(20, 3)))
    y = (shown(truth, 0) + noise * rng.normal(size=(20, 9)))[:, None]
    covariance = np.stack([sigma**2 * np.eye(3)] * 20)

    def cost(q):
        misfit = ((y[:, 0] - shown(q, 0)) ** 2).sum(-1) / noise**2
        return 0.5 * misfit + 0.5 * (model.difference(q, start) ** 2).sum(-1) / sigma**2

    def slope(q):
        steps = 1e-5 * np.eye(3)
        return np.stack(
            [(cost(model.retract(q, e)) - cost(model.retract(q, -e))) / 2e-5 for e in steps], -1
        )

    plain = extended(model, start, covariance, y)
    iterated = extended(model, start, covariance, y, iterations=50, tolerance=1e-8)
    assert (np.abs(slope(iterated.state[:, 0]) * iterated.sigma[:, 0]) < 1e-4).all()
    assert np.abs(slope(plain.state[:, 0]) * plain.sigma[:, 0]).max() > 0.1
    np.testing.assert_allclose(np.linalg.norm(iterated.state, axis=-1), 1.0, rtol=1e-12)


def test_ambiguous_sign_is_left_to_the_model():
    """A measurement known up to its sign, as that of a quaternion, read either way."""
    free, start, y, flipped = either_sign()
    a = extended(free._replace(innovation=CIRCLE.innovation), *start, y, iterations=5)
    b = extended(free, *start, flipped, iterations=5)
    assert np.array_equal(a.state, b.state)


def test_a_retraction_may_project_the_corrected_state():
    """Without a difference of its own, a model is perturbed by addition, off the circle."""
    model, drawn, given = projecting()
    history = extended(model, *given, iterations=4)
    np.testing.assert_allclose(np.linalg.norm(history.state, axis=-1), 1.0, rtol=1e-14)
    assert np.abs(np.concatenate(drawn) - 1.0).max() > 1e-5
