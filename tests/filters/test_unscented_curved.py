"""States whose errors live in another space."""

import numpy as np
import pytest

from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from debrisest.filters.model import Model

Q = np.diag([1e-3, 1e-4])
R = 0.05 * np.eye(2)
NAMES = ("angle", "rate")


def angle_model():
    """State (angle, rate)."""
    return Model(
        process=lambda x, _: np.stack([x[..., 0] + x[..., 1], x[..., 1]], axis=-1),
        measurement=lambda x, _: np.stack([np.cos(x[..., 0]), np.sin(x[..., 0])], axis=-1),
        process_noise=Q,
        measurement_noise=R,
        error_names=NAMES,
    )


def rotated(x, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x[..., 0] - s * x[..., 1], s * x[..., 0] + c * x[..., 1]], axis=-1)


def circle_model():
    """State (cos, sin, rate), errors (angle, rate)."""

    def retract(x, e):
        rate = x[..., 2] + e[..., 1]
        return np.concatenate([rotated(x, e[..., 0]), rate[..., None]], axis=-1)

    def difference(x, y):
        sine = y[..., 0] * x[..., 1] - y[..., 1] * x[..., 0]
        cosine = y[..., 0] * x[..., 0] + y[..., 1] * x[..., 1]
        return np.stack([np.arctan2(sine, cosine), x[..., 2] - y[..., 2]], axis=-1)

    return Model(
        process=lambda x, _: np.concatenate([rotated(x, x[..., 2]), x[..., 2:]], axis=-1),
        measurement=lambda x, _: x[..., :2],
        process_noise=Q,
        measurement_noise=R,
        error_names=NAMES,
        retract=retract,
        difference=difference,
    )


@pytest.mark.parametrize("redraw", [False, True])
@pytest.mark.parametrize("spread", [UnscentedParameters(), UnscentedParameters(0.5, 2.0, 1.0)])
def test_circle_equals_angle(spread, redraw):
    rng = np.random.default_rng(0)
    runs, epochs = 6, 60
    angle, rate = rng.uniform(-3, 3, size=runs), rng.normal(0.4, 0.1, size=runs)
    path = angle[:, None] + rate[:, None] * np.arange(epochs)
    y = np.stack([np.cos(path), np.sin(path)], axis=-1) + np.sqrt(0.05) * rng.normal(
        size=(runs, epochs, 2)
    )
    y[:, ::7, 1] = np.nan
    start = np.stack([angle + 0.1, np.full(runs, 0.4)], axis=-1)
    circle = np.stack([np.cos(start[:, 0]), np.sin(start[:, 0]), start[:, 1]], axis=-1)
    covariance = np.stack([np.diag([0.04, 0.01])] * runs)

    flat = unscented(angle_model(), start, covariance, y, spread, redraw=redraw)
    curved = unscented(circle_model(), circle, covariance, y, spread, redraw=redraw)
    np.testing.assert_allclose(curved.state[..., 0], np.cos(flat.state[..., 0]), atol=1e-11)
    np.testing.assert_allclose(curved.state[..., 1], np.sin(flat.state[..., 0]), atol=1e-11)
    np.testing.assert_allclose(curved.state[..., 2], flat.state[..., 1], atol=1e-11)
    np.testing.assert_allclose(curved.sigma, flat.sigma, rtol=1e-10)
    np.testing.assert_allclose(curved.covariance, flat.covariance, atol=1e-12)
    np.testing.assert_allclose(curved.nis, flat.nis, rtol=1e-9, atol=1e-11)
    assert np.abs(flat.state[:, -1, 1] - rate).max() < 0.1


def test_a_retraction_may_project_the_corrected_state():
    def onto_circle(x, e):
        moved = x + e
        return moved / np.linalg.norm(moved, axis=-1, keepdims=True)

    drawn = []

    def measurement(x, _):
        drawn.append(np.linalg.norm(x, axis=-1))
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
    history = unscented(model, start, np.stack([0.1 * np.eye(2)] * 3), y)
    np.testing.assert_allclose(np.linalg.norm(history.state, axis=-1), 1.0, rtol=1e-14)
    assert np.abs(np.array(drawn) - 1.0).max() > 0.01


def test_ambiguous_sign_is_left_to_the_model():
    """A measurement known up to its sign, as that of a quaternion, read either way."""

    def nearest(y, predicted):
        sign = np.where((y * predicted).sum(-1, keepdims=True) < 0, -1.0, 1.0)
        return sign * y - predicted

    rng = np.random.default_rng(0)
    path = 0.4 * np.arange(40)
    y = np.stack([np.cos(path), np.sin(path)], axis=-1) + 0.05 * rng.normal(size=(1, 40, 2))
    flipped = y * rng.choice([-1.0, 1.0], size=(1, 40, 1))
    model = circle_model()._replace(innovation=nearest, measurement_noise=0.0025 * np.eye(2))
    start, covariance = np.array([[1.0, 0.0, 0.35]]), np.diag([0.01, 0.01])[None]
    plain = unscented(model._replace(innovation=lambda a, b: a - b), start, covariance, y)
    free = unscented(model, start, covariance, flipped)
    assert np.array_equal(plain.state, free.state)
