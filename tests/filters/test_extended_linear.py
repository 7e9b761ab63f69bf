"""On linear models the extended filter, iterated or not, is the textbook Kalman filter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from debrisest.filters.kalman.extended import extended
from tests.filters.linear_system import assert_kalman, problem

VARIANTS = [{}, {"iterations": 4}, {"iterations": 4, "stop": "relative_norm", "tolerance": 1e-9}]


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 6),
    m=st.integers(1, 5),
    variant=st.sampled_from(VARIANTS),
    jacobians=st.booleans(),
)
def test_equals_kalman(seed, n, m, variant, jacobians):
    system, start, covariance, y = problem(seed, n, m)
    epochs = range(y.shape[1])
    model = system.model(jacobians=jacobians)
    history = extended(model, start, covariance, y, keep=epochs, **variant)
    assert_kalman(history, system, start, covariance, y)
    assert history.counts["updates"].max() <= 2 or "stop" in variant
    assert not any(history.counts[name].any() for name in history.counts.keys() - {"updates"})


@pytest.mark.parametrize("variant", VARIANTS)
@given(seed=st.integers(0, 2**32 - 1), jacobians=st.booleans())
@settings(max_examples=20, deadline=None)
def test_nan_component_equals_a_model_without_it(variant, seed, jacobians):
    system, start, covariance, y = problem(seed, n=4, m=5, missing=0.0)
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
    system, start, covariance, y = problem(1, n=4, m=3, missing=0.0)
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
    system, start, covariance, y = problem(2, n=3, m=2, missing=1.0)
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
    system, start, covariance, y = problem(3, n=5, m=3, epochs=30)
    covariance *= 1e8
    history = extended(system.model(), start, covariance, y, keep=range(30))
    assert np.array_equal(history.covariance, np.swapaxes(history.covariance, -2, -1))
    assert (np.linalg.eigvalsh(history.covariance) > 0).all()
