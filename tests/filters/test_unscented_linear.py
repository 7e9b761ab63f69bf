"""On linear models the unscented filter is the textbook Kalman filter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from tests.filters.linear_system import assert_kalman, problem

SPREADS = [
    UnscentedParameters(),
    UnscentedParameters(alpha=1.0, beta=0.0, kappa=1.0),
    UnscentedParameters(alpha=0.3, beta=2.0, kappa=0.0),
    UnscentedParameters(alpha=1.0, beta=0.0, kappa=-0.5),
]


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
    system, start, covariance, y = problem(seed, n, m)
    system.q *= redraw
    history = unscented(
        system.model(), start, covariance, y, spread, keep=range(y.shape[1]), redraw=redraw
    )
    assert_kalman(history, system, start, covariance, y)
    assert not history.counts["repairs"].any()


@pytest.mark.parametrize("redraw", [False, True])
@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_nan_component_equals_a_model_without_it(redraw, seed):
    system, start, covariance, y = problem(seed, n=4, m=5, missing=0.0)
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
    system, start, covariance, y = problem(1, n=4, m=3, missing=0.0)
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
    system, start, covariance, y = problem(2, n=3, m=2, missing=1.0)
    history = unscented(system.model(), start, covariance, y)
    assert np.array_equal(history.state[:, 0], start)
    assert not history.nis.any()
    assert not history.nis_dof.any()
