"""NEES at the epochs whose covariance was kept, and nowhere else."""

import numpy as np
import pytest

from debrisest.assessment.nees import covariance_epochs, deviation, nees

TIMES = 0.5 * np.arange(7)
DATA = {"time_s": TIMES, "covariance_time_s": TIMES[[1, 4, 6]]}


def test_it_counts_the_dimensions_where_the_covariance_was_kept():
    error = np.array([[[3.0, 0.0], [1.0, 1.0], [0.0, 4.0]], [[0.0, 0.0], [2.0, 2.0], [6.0, 0.0]]])
    covariance = np.broadcast_to(np.diag([9.0, 4.0]), (2, 3, 2, 2))
    found = nees(DATA, error, covariance)
    wanted = np.full((2, 7), np.nan)
    wanted[0, [1, 4, 6]] = [0.5, (1 / 9 + 1 / 4) / 2, 2.0]
    wanted[1, [1, 4, 6]] = [0.0, (4 / 9 + 1) / 2, 2.0]
    np.testing.assert_allclose(found["nees"], wanted, rtol=1e-14)
    np.testing.assert_array_equal(found["nees_dof"], np.where(np.isnan(wanted), 0, 2))
    np.testing.assert_array_equal(covariance_epochs(DATA), [1, 4, 6])


@pytest.mark.parametrize("spoilt", ["error", "covariance"])
def test_what_is_not_known_does_not_count(spoilt):
    given = {"error": np.ones((1, 3, 2)), "covariance": np.tile(np.eye(2), (1, 3, 1, 1))}
    given[spoilt][0, 1, 0] = np.nan
    found = nees(DATA, **given)
    np.testing.assert_array_equal(np.isfinite(found["nees"][0]).nonzero()[0], [1, 6])
    np.testing.assert_array_equal(found["nees_dof"][0].nonzero()[0], [1, 6])


def test_the_deviation_is_that_of_the_worst_number():
    error = np.array([[[3.0, 0.5], [-1.0, 1.0], [0.0, -4.0]]])
    covariance = np.broadcast_to(np.array([[9.0, 1.0], [1.0, 4.0]]), (1, 3, 2, 2))
    found = deviation(DATA, error, covariance)["deviation"]
    np.testing.assert_allclose(found[0, [1, 4, 6]], [1.0, 0.5, 2.0], rtol=1e-14)
    assert np.isnan(found[0, [0, 2, 3, 5]]).all()
