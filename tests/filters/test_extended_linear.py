"""On linear models the extended filter, iterated or not, is the textbook Kalman filter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from debrisest.filters.kalman.extended import extended
from debrisest.filters.model import Model

VARIANTS = [{}, {"iterations": 4}, {"iterations": 4, "stop": "relative_norm", "tolerance": 1e-9}]


class System:
    """A random linear system that changes at every epoch."""

    def __init__(self, rng, n, m, epochs):
        self.transition = np.linalg.qr(rng.normal(size=(epochs, n, n)))[0]
        self.observation = rng.normal(size=(epochs, m, n))
        self.q, self.r = _covariance(rng, n), _covariance(rng, m)

    def model(self, rows=slice(None), jacobians=False):
        model = Model(
            process=lambda x, k: x @ self.transition[k].T,
            measurement=lambda x, k: x @ self.observation[k, rows].T,
            process_noise=self.q,
            measurement_noise=self.r[rows][:, rows],
            error_names=tuple(f"x{i}" for i in range(len(self.q))),
        )
        if not jacobians:
            return model
        return model._replace(
            process_jacobian=lambda _, k: self.transition[k],
            measurement_jacobian=lambda _, k: self.observation[k, rows],
        )

    def kalman(self, x, p, measurements):
        """Information form; the rows of missing components are cut out of the matrices."""
        for k, y in enumerate(measurements):
            if k > 0:
                f = self.transition[k - 1]
                x, p = f @ x, f @ p @ f.T + self.q
            rows = ~np.isnan(y)
            h, r = self.observation[k, rows], self.r[np.ix_(rows, rows)]
            nu, s = y[rows] - h @ x, h @ p @ h.T + r
            weighted = h.T @ np.linalg.inv(r)
            p = np.linalg.inv(np.linalg.inv(p) + weighted @ h)
            x = x + p @ weighted @ nu
            yield x, p, nu @ np.linalg.inv(s) @ nu


def _covariance(rng, n):
    root = rng.normal(size=(n, n))
    return root @ root.T / n + 0.1 * np.eye(n)


def _problem(seed, n, m, runs=3, epochs=8, missing=0.3):
    rng = np.random.default_rng(seed)
    system = System(rng, n, m, epochs)
    y = rng.normal(size=(runs, epochs, m))
    y[rng.random(y.shape) < missing] = np.nan
    start = rng.normal(size=(runs, n))
    covariance = np.stack([_covariance(rng, n) for _ in range(runs)])
    return system, start, covariance, y


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 6),
    m=st.integers(1, 5),
    variant=st.sampled_from(VARIANTS),
    jacobians=st.booleans(),
)
def test_equals_kalman(seed, n, m, variant, jacobians):
    system, start, covariance, y = _problem(seed, n, m)
    epochs = range(y.shape[1])
    model = system.model(jacobians=jacobians)
    history = extended(model, start, covariance, y, keep=epochs, **variant)
    for run in range(len(y)):
        for k, (x, p, nis) in enumerate(system.kalman(start[run], covariance[run], y[run])):
            np.testing.assert_allclose(history.state[run, k], x, rtol=1e-10, atol=1e-10)
            np.testing.assert_allclose(history.covariance[run, k], p, rtol=1e-10, atol=1e-10)
            np.testing.assert_allclose(history.nis[run, k], nis, rtol=1e-8, atol=1e-10)
            np.testing.assert_allclose(history.sigma[run, k], np.sqrt(np.diagonal(p)), rtol=1e-7)
    assert np.array_equal(history.nis_dof, np.isfinite(y).sum(-1))
    assert history.counts["updates"].max() <= 2 or "stop" in variant
    assert not any(history.counts[name].any() for name in history.counts.keys() - {"updates"})


@pytest.mark.parametrize("variant", VARIANTS)
@given(seed=st.integers(0, 2**32 - 1), jacobians=st.booleans())
@settings(max_examples=20, deadline=None)
def test_nan_component_equals_a_model_without_it(variant, seed, jacobians):
    system, start, covariance, y = _problem(seed, n=4, m=5, missing=0.0)
    rows = np.array([0, 2, 3])
    spoiled = y.copy()
    spoiled[..., [1, 4]] = np.nan
    masked = extended(system.model(jacobians=jacobians), start, covariance, spoiled, **variant)
    kept = system.model(rows, jacobians)
    dropped = extended(kept, start, covariance, y[..., rows], **variant)
    accuracy = 1e-12 if jacobians else 1e-10
    for name in ("state", "sigma", "covariance", "nis", "nis_dof"):
        np.testing.assert_allclose(
            getattr(masked, name), getattr(dropped, name), rtol=1e-9, atol=accuracy
        )


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("jacobians", [False, True])
def test_what_is_predicted_for_a_missing_component_does_not_matter(jacobians, variant):
    system, start, covariance, y = _problem(1, n=4, m=3, missing=0.0)
    y[:, ::2, 1] = np.nan
    model = system.model(jacobians=jacobians)

    def spoil(f, component):
        def spoiled(x, k):
            values = f(x, k).copy()
            if k % 2 == 0:
                values[component] = np.nan
            return values

        return spoiled if f else None

    other = model._replace(
        measurement=spoil(model.measurement, (..., 1)),
        measurement_jacobian=spoil(model.measurement_jacobian, (1, ...)),
    )
    sound = extended(model, start, covariance, y, **variant)
    spoiled = extended(other, start, covariance, y, **variant)
    assert np.array_equal(sound.counts["updates"], spoiled.counts["updates"])
    for a, b in zip(sound[:-1], spoiled[:-1]):
        assert np.array_equal(a, b)


def test_nothing_measured_is_prediction_alone():
    system, start, covariance, y = _problem(2, n=3, m=2, missing=1.0)
    history = extended(system.model(), start, covariance, y, iterations=5)
    assert np.array_equal(history.state[:, 0], start)
    assert not history.nis.any()
    assert not history.nis_dof.any()
    x, p = start[0], covariance[0]
    for f in system.transition[: y.shape[1] - 1]:
        x, p = f @ x, f @ p @ f.T + system.q
    np.testing.assert_allclose(history.state[0, -1], x, atol=1e-12)
    np.testing.assert_allclose(history.covariance[0, -1], p, atol=1e-10)


def test_covariance_is_symmetric_to_the_last_bit_and_positive():
    system, start, covariance, y = _problem(3, n=5, m=3, epochs=30)
    covariance *= 1e8
    history = extended(system.model(), start, covariance, y, keep=range(30))
    assert np.array_equal(history.covariance, np.swapaxes(history.covariance, -2, -1))
    assert (np.linalg.eigvalsh(history.covariance) > 0).all()
