"""Against the equations written out point by point, and against exact Gaussian moments."""

import numpy as np
import pytest

from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from debrisest.filters.model import Model

Q = np.array([[1e-3, 2e-4], [2e-4, 2e-3]])
R = np.array([[0.02, 0.01], [0.01, 0.05]])
PAPER = UnscentedParameters()


def pendulum(x, k):
    angle, rate = x[..., 0], x[..., 1]
    rate = rate - 0.3 * np.sin(angle) + 0.01 * k
    return np.stack([angle + 0.3 * rate, rate], axis=-1)


def shown(x, k):
    angle, rate = x[..., 0], x[..., 1]
    return np.stack([np.sin(angle) + 0.01 * k, angle * rate], axis=-1)


def oracle(x, p, measurements, spread, redraw):
    """Eqs 32-42 for one run, with the weight matrix W that takes the mean out."""
    n = len(x)
    scaled = spread.alpha**2 * (n + spread.kappa)
    w_m = np.array([1 - n / scaled] + [0.5 / scaled] * (2 * n))
    w_c = w_m.copy()
    w_c[0] += 1 - spread.alpha**2 + spread.beta
    about_mean = np.eye(2 * n + 1) - np.outer(w_m, np.ones(2 * n + 1))
    w = about_mean @ np.diag(w_c) @ about_mean.T

    def draw(x, p):
        root = np.sqrt(scaled) * np.linalg.cholesky(p)
        return np.column_stack([x] + [x + c for c in root.T] + [x - c for c in root.T])

    def through(f, points, k):
        return np.column_stack([f(point, k) for point in points.T])

    for k, y in enumerate(measurements):
        points = draw(x, p)
        if k > 0:
            points = through(pendulum, points, k - 1)
            x, p = points @ w_m, points @ w @ points.T + Q
            points = draw(x, p) if redraw else points
        predicted = through(shown, points, k)
        s = predicted @ w @ predicted.T + R
        gain = points @ w @ predicted.T @ np.linalg.inv(s)
        x, p = x + gain @ (y - predicted @ w_m), p - gain @ s @ gain.T
        yield x, p


@pytest.mark.parametrize("redraw", [False, True])
@pytest.mark.parametrize(
    "spread", [PAPER, UnscentedParameters(0.5, 2.0, 1.0), UnscentedParameters(1.0, 0.0, -0.5)]
)
def test_equals_the_equations_point_by_point(spread, redraw):
    rng = np.random.default_rng(0)
    start = rng.normal(size=(3, 2))
    covariance = np.stack([np.diag(d) for d in rng.uniform(0.05, 0.3, size=(3, 2))])
    y = rng.normal(size=(3, 15, 2))
    model = Model(pendulum, shown, Q, R, ("angle", "rate"))
    history = unscented(model, start, covariance, y, spread, keep=range(15), redraw=redraw)
    for run in range(3):
        for k, (x, p) in enumerate(oracle(start[run], covariance[run], y[run], spread, redraw)):
            np.testing.assert_allclose(history.state[run, k], x, atol=1e-11)
            np.testing.assert_allclose(history.covariance[run, k], p, atol=1e-11)


def test_covariance_is_symmetric_to_the_last_bit_and_positive():
    rng = np.random.default_rng(0)
    model = Model(pendulum, shown, Q, R, ("angle", "rate"))
    history = unscented(
        model,
        np.zeros((4, 2)),
        np.stack([np.eye(2)] * 4),
        rng.normal(size=(4, 30, 2)),
        keep=range(30),
    )
    assert np.array_equal(history.covariance, np.swapaxes(history.covariance, -2, -1))
    assert (np.linalg.eigvalsh(history.covariance) > 0).all()


def quadratic_model(r=0.3, q=0.1):
    """x -> x + c x^2, of which x^2 is seen: three points at sqrt(3) sigma give exact moments."""
    return Model(
        process=lambda x, _: x + 0.2 * x**2,
        measurement=lambda x, _: x**2,
        process_noise=np.array([[q]]),
        measurement_noise=np.array([[r]]),
        error_names=("x",),
    )


EXACT = UnscentedParameters(alpha=1.0, beta=0.0, kappa=2.0)


def test_prediction_has_the_exact_moments_of_a_quadratic():
    mean, variance = np.array([0.4, -1.0, 2.0]), np.array([0.5, 1.0, 0.1])
    nothing = np.full((3, 2, 1), np.nan)
    history = unscented(quadratic_model(), mean[:, None], variance[:, None, None], nothing, EXACT)
    slope = 1 + 0.4 * mean
    exact = slope**2 * variance + 2 * 0.2**2 * variance**2 + 0.1
    np.testing.assert_allclose(
        history.state[:, 1, 0], mean + 0.2 * (mean**2 + variance), rtol=1e-12
    )
    np.testing.assert_allclose(history.covariance[:, 0, 0, 0], exact, rtol=1e-12)


def test_update_has_the_exact_moments_of_a_quadratic():
    mean, variance, y = np.array([0.4, -1.0, 2.0]), np.array([0.5, 1.0, 0.1]), 1.7
    measured = np.full((3, 1, 1), y)
    history = unscented(quadratic_model(), mean[:, None], variance[:, None, None], measured, EXACT)
    seen = 4 * mean**2 * variance + 2 * variance**2 + 0.3
    gain = 2 * mean * variance / seen
    innovation = y - mean**2 - variance
    np.testing.assert_allclose(history.state[:, 0, 0], mean + gain * innovation, rtol=1e-12)
    np.testing.assert_allclose(
        history.covariance[:, 0, 0, 0], variance - gain**2 * seen, rtol=1e-12
    )
    np.testing.assert_allclose(history.nis[:, 0], innovation**2 / seen, rtol=1e-12)
