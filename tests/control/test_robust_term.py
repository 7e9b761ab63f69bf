"""Readings of the robust term against each other and their bounds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.control.attitude_hold import GAINS
from debrisest.control.robust_term import Uncertainty, robust_term

UNCERTAINTY = Uncertainty(drift=0.1, gain=0.4)
numbers = st.lists(st.floats(-50.0, 50.0), min_size=3, max_size=3).map(np.array)


def term(reading, feedback, drift, surface):
    return robust_term(reading, feedback, drift, surface, GAINS, UNCERTAINTY)


@given(numbers, numbers, numbers)
def test_the_literal_reading_solves_the_printed_equation(feedback, drift, surface) -> None:
    share = np.eye(3) - 0.4 * np.eye(3)
    right = 0.1 * np.abs(drift) + 0.4 * feedback + 0.001 * surface
    found = term("literal", feedback, drift, surface)
    np.testing.assert_allclose(share @ found, right, atol=1e-12)


@given(numbers, numbers, numbers)
def test_with_the_sign_of_s_the_term_covers_the_uncertainty(feedback, drift, surface) -> None:
    found = term("sign", feedback, drift, surface)
    assert np.all(found * surface >= 0.0)
    worst = 0.1 * np.abs(drift) + 0.4 * np.abs(feedback + found)
    assert np.all((np.abs(found) >= worst - 1e-9) | (surface == 0.0))


@given(numbers, numbers, numbers)
def test_saturated_is_sign_outside_its_boundary_and_no_larger_inside(f, d, s) -> None:
    saturated, sign = term("saturated", f, d, s), term("sign", f, d, s)
    assert np.all(np.abs(saturated) <= np.abs(sign) + 1e-12)
    outside = np.abs(s) > GAINS.boundary
    np.testing.assert_array_equal(saturated[outside], sign[outside])


@pytest.mark.parametrize("reading", ["literal", "conditional", "saturated", "sign", "none"])
def test_nothing_wanted_and_nothing_wrong_gives_nothing(reading) -> None:
    np.testing.assert_array_equal(term(reading, *np.zeros((3, 3))), 0.0)
