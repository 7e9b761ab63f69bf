"""Range and bearing of a moving point: derivatives, oracles of a single run, other filters."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from debrisest.filters.kalman import jacobian
from debrisest.filters.kalman.extended import extended
from debrisest.filters.kalman.unscented import unscented
from debrisest.filters.model import Model

R = np.diag([0.2**2, 0.01**2])
Q = np.diag([1e-3, 1e-3, 1e-4, 1e-4])
P0 = np.diag([1.0, 0.5, 0.01, 0.01])
NAMES = ("x", "y", "v_x", "v_y")


def drifted(x, k):
    """A damped motion, nonlinear in the velocity."""
    v = x[..., 2:] * (1 - 0.1 * np.linalg.norm(x[..., 2:], axis=-1, keepdims=True))
    return np.concatenate([x[..., :2] + v, v], axis=-1)


def drifted_jacobian(x, k):
    v = x[..., 2:]
    speed = np.linalg.norm(v, axis=-1)[..., None, None]
    slope = (1 - 0.1 * speed) * np.eye(2) - 0.1 * v[..., :, None] * v[..., None, :] / speed
    f = np.zeros((*x.shape, 4))
    f[..., :2, :2], f[..., :2, 2:], f[..., 2:, 2:] = np.eye(2), slope, slope
    return f


def seen(x, k):
    return np.stack([np.hypot(x[..., 0], x[..., 1]), np.arctan2(x[..., 1], x[..., 0])], axis=-1)


def seen_jacobian(x, k):
    px, py = x[..., 0], x[..., 1]
    r = np.hypot(px, py)
    zero = 0 * r
    rows = [[px / r, py / r, zero, zero], [-py / r**2, px / r**2, zero, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def wrapped(y, predicted):
    residual = y - predicted
    turn = np.array([0.0, 2 * np.pi])
    return residual - turn * np.round(residual / (2 * np.pi))


NUMERIC = Model(drifted, seen, Q, R, NAMES, innovation=wrapped)
GIVEN = NUMERIC._replace(process_jacobian=drifted_jacobian, measurement_jacobian=seen_jacobian)


ACROSS_THE_CUT = np.array([-20.0, 0.0, 0.6, 0.5])
"""Start with a bearing of 180 degrees, on either side of the cut of the arc tangent."""


def campaign(seed, runs=8, epochs=20, scale=1.0, p0=P0, mean=ACROSS_THE_CUT):
    """Start and measurements, all their noise multiplied by `scale`."""
    rng = np.random.default_rng(seed)
    x = mean + scale * rng.multivariate_normal(np.zeros(4), p0, size=runs)
    y = np.empty((runs, epochs, 2))
    for k in range(epochs):
        if k > 0:
            x = drifted(x, k) + scale * rng.multivariate_normal(np.zeros(4), Q, size=runs)
        noise = scale * rng.multivariate_normal(np.zeros(2), R, size=runs)
        y[:, k] = wrapped(seen(x, k) + noise, 0.0)
    return np.tile(mean, (runs, 1)), scale**2 * np.tile(p0, (runs, 1, 1)), y


def scaled(model, scale):
    noises = {"process_noise": scale**2 * Q, "measurement_noise": scale**2 * R}
    return model._replace(**noises)


@pytest.mark.parametrize("sigma", [1e3, 1.0, 1e-3, 1e-6])
def test_numeric_jacobians(sigma):
    rng = np.random.default_rng(0)
    x = np.concatenate([[[-20.0, 0.0, 0.3, 0.4]], rng.normal(5, 1, size=(5, 4))])
    covariance = np.tile(sigma**2 * np.eye(4), (6, 1, 1))
    moved, f = jacobian.process(NUMERIC, x, covariance, 0)
    shown, h = jacobian.measurement(NUMERIC, x, covariance, 0)
    assert np.array_equal(moved, drifted(x, 0))
    assert np.array_equal(shown, seen(x, 0))
    accuracy = 1e-6 if sigma > 0.1 else 1e-8 if sigma > 1e-5 else 1e-5
    np.testing.assert_allclose(f, drifted_jacobian(x, 0), atol=accuracy)
    np.testing.assert_allclose(h, seen_jacobian(x, 0), atol=accuracy)


def test_a_constant_keeps_a_row_of_exactly_one():
    model = Model(lambda x, _: x, lambda x, _: x, np.eye(3), np.eye(3), ("a", "b", "c"))
    x = np.random.default_rng(0).normal(size=(50, 3)) * [1.0, 60.0, 7e6]
    covariance = np.tile(np.diag([1e-14, 1e-8, 1e-4]), (50, 1, 1))
    _, f = jacobian.process(model, x, covariance, 0)
    assert np.array_equal(f, np.tile(np.eye(3), (50, 1, 1)))


@pytest.mark.parametrize("iterations", [1, 20])
def test_given_jacobians_change_nothing_but_rounding(iterations):
    problem = campaign(0)
    rule = {"iterations": iterations, "tolerance": 1e-9}
    a, b = (extended(model, *problem, **rule) for model in (NUMERIC, GIVEN))
    np.testing.assert_allclose(a.state, b.state, atol=1e-6)
    np.testing.assert_allclose(a.covariance, b.covariance, atol=1e-7)
    np.testing.assert_allclose(a.nis, b.nis, atol=1e-5)


def oracle(x, p, measurements, steps):
    """One run with a fixed number of steps, each a linear least-squares problem of its own."""
    root_r = np.linalg.inv(np.linalg.cholesky(R))
    for k, y in enumerate(measurements):
        if k > 0:
            f = drifted_jacobian(x, k)
            x, p = drifted(x, k), f @ p @ f.T + Q
        root_p, prior = np.linalg.inv(np.linalg.cholesky(p)), x
        for _ in range(steps):
            h = seen_jacobian(x, k)
            a = np.vstack([root_p, root_r @ h])
            b = np.concatenate([root_p @ (prior - x), root_r @ wrapped(y, seen(x, k))])
            x = x + np.linalg.lstsq(a, b)[0]
        p = np.linalg.inv(a.T @ a)
        yield x, p


@pytest.mark.parametrize("steps", [1, 2, 3])
def test_equals_least_squares_step_by_step(steps):
    problem = campaign(1, runs=4)
    history = extended(GIVEN, *problem, iterations=steps, tolerance=1e-300, keep=range(20))
    for run in range(4):
        for k, (x, p) in enumerate(oracle(*(part[run] for part in problem), steps)):
            np.testing.assert_allclose(history.state[run, k], x, atol=1e-9)
            np.testing.assert_allclose(history.covariance[run, k], p, atol=1e-10)


def most_probable(mean, covariance, y):
    root = np.linalg.inv(np.linalg.cholesky(covariance))
    root_r = np.linalg.inv(np.linalg.cholesky(R))

    def residual(x):
        return np.concatenate([root @ (x - mean), root_r @ wrapped(y, seen(x, 0))])

    options = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
    found = least_squares(residual, mean, **options)
    return found.x, 2.0 * found.cost


@pytest.mark.parametrize("model", [NUMERIC, GIVEN])
@pytest.mark.parametrize("stop", ["scaled", "relative_norm"])
def test_iterated_update_is_the_most_probable_state(model, stop):
    start, covariance, y = campaign(2, runs=30, epochs=1, p0=4 * P0)
    rule = {"iterations": 100, "tolerance": 1e-10, "stop": stop}
    history = extended(model, start, covariance, y, **rule)
    found = [most_probable(*one) for one in zip(start, covariance, y[:, 0])]
    exact, least = (np.array(part) for part in zip(*found))
    np.testing.assert_allclose(history.state[:, 0], exact, atol=1e-6)
    np.testing.assert_allclose(history.nis[:, 0], least, rtol=1e-5)
    plain = extended(model, start, covariance, y)
    assert np.abs(plain.state[:, 0] - exact).max() > 0.01
    assert history.counts["updates"].min() > 2 and history.counts["updates"].max() < 100
    assert (plain.counts["updates"] == 1).all()
    assert not np.allclose(history.nis, plain.nis, rtol=0.05)


def test_scaled_rule_ends_within_its_tolerance():
    problem = campaign(3, runs=50, epochs=1, p0=4 * P0)
    exact = extended(GIVEN, *problem, iterations=100, tolerance=1e-12)
    near = extended(GIVEN, *problem, iterations=100, tolerance=0.01)
    assert (near.counts["updates"] < exact.counts["updates"]).all()
    assert (np.abs(near.state - exact.state) < 0.01 * exact.sigma).all()


def test_relative_norm_is_blind_far_from_the_origin():
    """The rule compares with the size of the state, not with what is known of it."""
    origin = np.array([1e4, 0.0, 0.0, 0.0])
    far = NUMERIC._replace(
        process=lambda x, k: drifted(x - origin, k) + origin,
        measurement=lambda x, k: seen(x - origin, k),
    )
    start, covariance, y = campaign(4)
    rule = {"iterations": 20, "stop": "relative_norm", "tolerance": 1e-2}
    blind = extended(far, start + origin, covariance, y, **rule)
    assert (blind.counts["updates"] == 1).all()
    assert (extended(NUMERIC, start, covariance, y, **rule).counts["updates"] > 1).any()
    scaled_rule = extended(far, start + origin, covariance, y, iterations=20)
    near = extended(NUMERIC, start, covariance, y, iterations=20)
    assert np.array_equal(scaled_rule.counts["updates"], near.counts["updates"])


@pytest.mark.parametrize("iterations", [1, 20])
def test_approaches_the_unscented_filter_as_noise_vanishes(iterations):
    """In units of sigma they differ by what curvature does within one sigma."""
    gaps = []
    for scale in (0.3, 0.03):
        problem = campaign(5, scale=scale, mean=-ACROSS_THE_CUT)
        model = scaled(NUMERIC, scale)
        a, b = (
            extended(model, *problem, iterations=iterations),
            unscented(model, *problem, redraw=True),
        )
        gaps.append(np.abs((a.state - b.state) / b.sigma).max())
        np.testing.assert_allclose(a.sigma, b.sigma, rtol=0.5 * scale)
    assert gaps[0] < 0.3
    assert gaps[1] < gaps[0] / 4
