"""On linear models the unscented filter is the Kalman filter, written here as in a textbook."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from debrisest.filters.model import Model

SPREADS = [
    UnscentedParameters(),
    UnscentedParameters(alpha=1.0, beta=0.0, kappa=1.0),
    UnscentedParameters(alpha=0.3, beta=2.0, kappa=0.0),
    UnscentedParameters(alpha=1.0, beta=0.0, kappa=-0.5),
]


class System:
    """A random linear system that changes at every epoch."""

    def __init__(self, rng, n, m, epochs):
        self.transition = np.linalg.qr(rng.normal(size=(epochs, n, n)))[0]
        self.observation = rng.normal(size=(epochs, m, n))
        self.q, self.r = _covariance(rng, n), _covariance(rng, m)

    def model(self, rows=slice(None)):
        return Model(
            process=lambda x, k: x @ self.transition[k].T,
            measurement=lambda x, k: x @ self.observation[k, rows].T,
            process_noise=self.q,
            measurement_noise=self.r[rows][:, rows],
            error_names=tuple(f"x{i}" for i in range(len(self.q))),
        )

    def kalman(self, x, p, measurements):
        """Textbook filter; the rows of missing components are cut out of the matrices."""
        states, covariances, nis = [], [], []
        for k, y in enumerate(measurements):
            if k > 0:
                f = self.transition[k - 1]
                x, p = f @ x, f @ p @ f.T + self.q
            rows = ~np.isnan(y)
            h, r = self.observation[k, rows], self.r[np.ix_(rows, rows)]
            s = h @ p @ h.T + r
            gain = p @ h.T @ np.linalg.inv(s)
            nu = y[rows] - h @ x
            x, p = x + gain @ nu, p - gain @ s @ gain.T
            states.append(x)
            covariances.append(p)
            nis.append(nu @ np.linalg.inv(s) @ nu)
        return np.array(states), np.array(covariances), np.array(nis)


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
    spread=st.sampled_from(SPREADS),
    redraw=st.booleans(),
)
def test_equals_kalman(seed, n, m, spread, redraw):
    """With redrawn points; without, the innovation covariance lacks Q, so only for Q = 0."""
    system, start, covariance, y = _problem(seed, n, m)
    system.q *= redraw
    history = unscented(
        system.model(), start, covariance, y, spread, keep=range(y.shape[1]), redraw=redraw
    )
    for run in range(len(y)):
        x, p, nis = system.kalman(start[run], covariance[run], y[run])
        np.testing.assert_allclose(history.state[run], x, rtol=1e-10, atol=1e-10)
        np.testing.assert_allclose(history.covariance[run], p, rtol=1e-10, atol=1e-10)
        np.testing.assert_allclose(history.nis[run], nis, rtol=1e-8, atol=1e-10)
        sigma = np.sqrt(np.diagonal(p, axis1=1, axis2=2))
        np.testing.assert_allclose(history.sigma[run], sigma, rtol=1e-7)
    assert np.array_equal(history.nis_dof, np.isfinite(y).sum(-1))
    assert not history.counts["repairs"].any()


@pytest.mark.parametrize("redraw", [False, True])
@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_nan_component_equals_a_model_without_it(redraw, seed):
    system, start, covariance, y = _problem(seed, n=4, m=5, missing=0.0)
    rows = np.array([0, 2, 3])
    spoiled = y.copy()
    spoiled[..., [1, 4]] = np.nan
    masked = unscented(system.model(), start, covariance, spoiled, redraw=redraw)
    dropped = unscented(system.model(rows), start, covariance, y[..., rows], redraw=redraw)
    for name in ("state", "sigma", "covariance", "nis", "nis_dof"):
        np.testing.assert_allclose(
            getattr(masked, name), getattr(dropped, name), rtol=1e-11, atol=1e-13
        )


def test_what_is_predicted_for_a_missing_component_does_not_matter():
    system, start, covariance, y = _problem(1, n=4, m=3, missing=0.0)
    y[..., 1] = np.nan
    model = system.model()

    def spoiled(x, k):
        shown = model.measurement(x, k)
        shown[..., 1] = np.nan
        return shown

    sound = unscented(model, start, covariance, y)
    other = unscented(model._replace(measurement=spoiled), start, covariance, y)
    for a, b in zip(sound[:-1], other[:-1]):
        assert np.array_equal(a, b)


def test_nothing_measured_is_prediction_alone():
    system, start, covariance, y = _problem(2, n=3, m=2, missing=1.0)
    history = unscented(system.model(), start, covariance, y)
    assert np.array_equal(history.state[:, 0], start)
    assert not history.nis.any()
    assert not history.nis_dof.any()
