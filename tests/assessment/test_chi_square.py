"""The chi-square functions against those of scipy, which takes a second to load."""

import numpy as np
from scipy.stats import chi2

from debrisest.assessment.chi_square import chance_above, upper_quantile

DOF = np.array([1, 2, 7, 40])
SQUARE = np.array([0.0, 1e-300, 0.3, 5.0, 100.0, 1e4, np.inf, -1.0])[:, None]


def test_the_chance_of_a_larger_square_is_that_of_scipy() -> None:
    square, dof = np.broadcast_arrays(SQUARE, DOF)
    assert np.array_equal(chance_above(square, dof), chi2.sf(square, dof))
    assert np.isnan(chance_above(np.array([np.nan]), np.array([2]))).all()
    assert chance_above(np.array([3.0]), np.array([0])) == 0.0


def test_the_upper_quantile_is_that_of_scipy() -> None:
    assert np.array_equal(upper_quantile(1e-6, DOF), chi2.isf(1e-6, DOF))
