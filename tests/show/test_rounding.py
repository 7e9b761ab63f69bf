"""Figures with the digits that their sigma leaves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.show.rounding import rounded, told


@pytest.mark.parametrize(
    ("value", "sigma", "expected"),
    [
        (3.14159, 0.0123, ("3.142", "0.012")),
        (3.14159, 0.0996, ("3.14", "0.10")),
        (-0.00004, 1.0, ("-0.0", "1.0")),
        (12345.6, 234.0, ("12350", "230")),
        (12345.6, 12.0, ("12346", "12")),
        (1.0, 0.0, ("1", "")),
        (0.25, np.nan, ("0.25", "")),
        (np.nan, 0.1, ("", "")),
        (np.inf, 0.1, ("", "")),
    ],
)
def test_two_digits_of_sigma(value: float, sigma: float, expected: tuple[str, str]) -> None:
    assert rounded(value, sigma) == expected


@given(st.floats(-1e9, 1e9), st.floats(1e-7, 1e7))
def test_what_is_left_out_is_far_below_sigma(value: float, sigma: float) -> None:
    """Half a unit of the second digit, and what float64 loses of the value."""
    figure, spread = rounded(value, sigma)
    assert abs(float(figure) - value) <= 0.0503 * sigma + 2 * np.spacing(abs(value))
    assert abs(float(spread) - sigma) <= 0.0503 * sigma


def test_in_one_text() -> None:
    assert told(3.14159, 0.012, "deg") == "3.142 ± 0.012 deg"
    assert told(2.0, 0.0, "s") == "2 s"
    assert told(np.nan, 1.0, "deg") == "undefined"
