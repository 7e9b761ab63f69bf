"""An angle that turns, as itself and as a point of the circle: states whose errors differ."""

import numpy as np

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
"""State (angle, rate)."""


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
"""State (cos, sin, rate), errors (angle, rate)."""


def on_circle(angular):
    """The states of `CIRCLE` that are those of `ANGLE`."""
    angle, rate = angular[..., 0], angular[..., 1]
    return np.stack([np.cos(angle), np.sin(angle), rate], axis=-1)


def turning():
    """Rates (run,), a start of `ANGLE` with its covariance, and measurements with gaps."""
    rng = np.random.default_rng(0)
    runs, epochs = 6, 60
    angle, rate = rng.uniform(-3, 3, size=runs), rng.normal(0.4, 0.1, size=runs)
    path = angle[:, None] + rate[:, None] * np.arange(epochs)
    y = np.stack([np.cos(path), np.sin(path)], axis=-1)
    y += np.sqrt(0.05) * rng.normal(size=y.shape)
    y[:, ::7, 1] = np.nan
    start = np.stack([angle + 0.1, np.full(runs, 0.4)], axis=-1)
    return rate, start, np.stack([np.diag([0.04, 0.01])] * runs), y


def either_sign():
    """A model whose measurement is known up to its sign, with a start, and measurements: with
    their sign, and with any."""

    def nearest(y, predicted):
        sign = np.where((y * predicted).sum(-1, keepdims=True) < 0, -1.0, 1.0)
        return sign * y - predicted

    rng = np.random.default_rng(0)
    path = 0.4 * np.arange(40)
    y = np.stack([np.cos(path), np.sin(path)], axis=-1) + 0.05 * rng.normal(size=(1, 40, 2))
    flipped = y * rng.choice([-1.0, 1.0], size=(1, 40, 1))
    free = CIRCLE._replace(measurement_noise=0.0025 * np.eye(2), innovation=nearest)
    return free, (np.array([[1.0, 0.0, 0.35]]), np.diag([0.01, 0.01])[None]), y, flipped


def projecting():
    """A model that brings corrected states back onto the circle, the norms of the states that it
    was asked to measure, and a start and measurements."""
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
    return model, drawn, (np.stack([[1.0, 0.0]] * 3), np.stack([0.1 * np.eye(2)] * 3), y)
