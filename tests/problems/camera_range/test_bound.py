"""The bound as an estimator: what the first guess leaves, and false matches it knows of."""

import numpy as np
import pytest

from debrisest.filters.bound.landmarks import landmark_bound


def bound(case, observed):
    known = case.core[:, 0], case.points, case.parameters, case.covariance
    return landmark_bound(case.model, *known, observed)


@pytest.fixture(scope="module")
def case(experiment):
    return experiment(2, 30, 40)


def test_without_measurements_the_error_is_that_of_the_first_guess(case) -> None:
    nothing = case.observed._replace(
        seen=np.zeros_like(case.observed.seen), common_seen=np.zeros_like(case.observed.common_seen)
    )
    found = bound(case, nothing)
    offset = case.parameters - case.model.parameters(case.core[:, 0])
    np.testing.assert_allclose(found.error[:, 0, 3:17], offset, atol=1e-9)
    np.testing.assert_allclose(found.error[:, :, 17:], 0.0, atol=1e-12)
    size = np.sqrt(np.diagonal(case.covariance, 0, 1, 2))
    np.testing.assert_allclose(found.sigma[:, 0, 3:], size, rtol=1e-9)


def test_a_false_match_counts_as_if_it_were_hidden(case) -> None:
    shown, seen = case.observed.shown.copy(), case.observed.seen.copy()
    shown[:, 7, 4, 0] += 50.0
    shown[0, 20, 1, 1] -= 9.0 + 5.0
    seen[:, 7, 4] = False
    seen[0, 20, 1] = False
    false = bound(case, case.observed._replace(shown=shown))
    hidden = bound(case, case.observed._replace(seen=seen))
    np.testing.assert_allclose(false.error, hidden.error, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(false.sigma, hidden.sigma, rtol=1e-9)
