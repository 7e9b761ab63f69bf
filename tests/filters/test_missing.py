import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from debrisest.filters.missing import drop_missing


@given(st.integers(0, 2**32 - 1), st.integers(1, 6))
def test_gain_is_that_of_the_measured_rows_alone(seed, m):
    rng = np.random.default_rng(seed)
    prior = _covariance(rng, 3)
    noise = _covariance(rng, m)
    jacobian = rng.normal(size=(m, 3))
    innovation = rng.normal(size=m)
    rows = rng.random(m) < 0.5

    kept = jacobian[rows]
    total = kept @ prior @ kept.T + noise[np.ix_(rows, rows)]
    gain = prior @ kept.T @ np.linalg.inv(total)

    spoiled = np.where(rows, innovation, np.nan)
    transposed = np.where(rows, jacobian.T, np.inf)
    nu, response, masked = drop_missing(rows, spoiled, transposed, noise)
    full = prior @ response @ np.linalg.inv(response.T @ prior @ response + masked)
    np.testing.assert_allclose(full[:, rows], gain, atol=1e-9 * (1 + np.abs(gain).max(initial=0)))
    assert not full[:, ~rows].any()
    np.testing.assert_allclose(
        full @ nu, gain @ innovation[rows], atol=1e-9 * (1 + abs(gain).sum())
    )


def test_nothing_missing_changes_nothing():
    rng = np.random.default_rng(0)
    innovation, response, noise = rng.normal(size=(4, 3)), rng.normal(size=(4, 7, 3)), np.eye(3)
    kept = drop_missing(np.ones((4, 3), dtype=bool), innovation, response, noise)
    assert np.array_equal(kept[0], innovation)
    assert np.array_equal(kept[1], response)
    assert np.array_equal(kept[2], np.broadcast_to(noise, (4, 3, 3)))


def _covariance(rng, n):
    root = rng.normal(size=(n, n))
    return root @ root.T + np.eye(n)
