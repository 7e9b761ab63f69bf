"""States whose errors live in another space."""

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.filters.kalman.extended import extended
from debrisest.filters.model import Model

Q = np.diag([1e-3, 1e-4])
R = 0.05 * np.eye(2)
NAMES = ("angle", "rate")
ANGLE = Model(
    process=lambda x, _: np.stack([x[..., 0] + x[..., 1], x[..., 1]], axis=-1),
    measurement=lambda x, _: np.stack([np.cos(x[..., 0]), np.sin(x[..., 0])], axis=-1),
    process_noise=Q,
    measurement_noise=R,
    error_names=NAMES,
)


def rotated(x, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x[..., 0] - s * x[..., 1], s * x[..., 0] + c * x[..., 1]], axis=-1)


def moved(x, e):
    rate = x[..., 2] + e[..., 1]
    return np.concatenate([rotated(x, e[..., 0]), rate[..., None]], axis=-1)


def apart(x, y):
    sine = y[..., 0] * x[..., 1] - y[..., 1] * x[..., 0]
    cosine = y[..., 0] * x[..., 0] + y[..., 1] * x[..., 1]
    return np.stack([np.arctan2(sine, cosine), x[..., 2] - y[..., 2]], axis=-1)


CIRCLE = Model(
    process=lambda x, _: np.concatenate([rotated(x, x[..., 2]), x[..., 2:]], axis=-1),
    measurement=lambda x, _: x[..., :2],
    process_noise=Q,
    measurement_noise=R,
    error_names=NAMES,
    retract=moved,
    difference=apart,
)
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
    rng = np.random.default_rng(0)
    runs, epochs = 6, 60
    angle, rate = rng.uniform(-3, 3, size=runs), rng.normal(0.4, 0.1, size=runs)
    path = angle[:, None] + rate[:, None] * np.arange(epochs)
    y = np.stack([np.cos(path), np.sin(path)], axis=-1)
    y += np.sqrt(0.05) * rng.normal(size=y.shape)
    y[:, ::7, 1] = np.nan
    start = np.stack([angle + 0.1, np.full(runs, 0.4)], axis=-1)
    on_circle = np.stack([np.cos(start[:, 0]), np.sin(start[:, 0]), start[:, 1]], axis=-1)
    covariance = np.stack([np.diag([0.04, 0.01])] * runs)
    rule = {"iterations": iterations, "tolerance": 1e-12}

    flat = extended(ANGLE, start, covariance, y, **rule)
    curved = extended(circle, on_circle, covariance, y, **rule)
    np.testing.assert_allclose(curved.state[..., 0], np.cos(flat.state[..., 0]), atol=1e-7)
    np.testing.assert_allclose(curved.state[..., 1], np.sin(flat.state[..., 0]), atol=1e-7)
    np.testing.assert_allclose(curved.state[..., 2], flat.state[..., 1], atol=1e-7)
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

    def nearest(y, predicted):
        sign = np.where((y * predicted).sum(-1, keepdims=True) < 0, -1.0, 1.0)
        return sign * y - predicted

    rng = np.random.default_rng(0)
    path = 0.4 * np.arange(40)
    y = np.stack([np.cos(path), np.sin(path)], axis=-1) + 0.05 * rng.normal(size=(1, 40, 2))
    flipped = y * rng.choice([-1.0, 1.0], size=(1, 40, 1))
    plain = CIRCLE._replace(measurement_noise=0.0025 * np.eye(2))
    free = plain._replace(innovation=nearest)
    start, covariance = np.array([[1.0, 0.0, 0.35]]), np.diag([0.01, 0.01])[None]
    a = extended(plain, start, covariance, y, iterations=5)
    b = extended(free, start, covariance, flipped, iterations=5)
    assert np.array_equal(a.state, b.state)


def test_a_retraction_may_project_the_corrected_state():
    """Without a difference of its own, a model is perturbed by addition, off the circle."""
    drawn = []

    def onto_circle(x, e):
        return (x + e) / np.linalg.norm(x + e, axis=-1, keepdims=True)

    def measurement(x, _):
        drawn.append(np.linalg.norm(x, axis=-1).ravel())
        return x

    model = Model(
        process=lambda x, _: rotated(x, 0.3),
        measurement=measurement,
        process_noise=1e-3 * np.eye(2),
        measurement_noise=R,
        error_names=("x", "y"),
        retract=onto_circle,
    )
    y = np.random.default_rng(0).normal(size=(3, 9, 2))
    start = np.stack([[1.0, 0.0]] * 3)
    history = extended(model, start, np.stack([0.1 * np.eye(2)] * 3), y, iterations=4)
    np.testing.assert_allclose(np.linalg.norm(history.state, axis=-1), 1.0, rtol=1e-14)
    assert np.abs(np.concatenate(drawn) - 1.0).max() > 1e-5
