"""The time from which an error stays small."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from debrisest.assessment.convergence import convergence_time

TIMES = np.array([0.0, 0.5, 1.0, 1.5])
END = 2.0


def settled(*error: float) -> float:
    return float(convergence_time(1.0, np.array([error]), TIMES)[0])


def test_by_hand() -> None:
    assert settled(0, 0, 0, 0) == 0.0
    assert settled(9, 0, 0, 0) == 0.5
    assert settled(0, 9, 0, 0) == 1.0
    assert settled(9, -9, -1, 1) == 1.0
    assert settled(9, 9, 9, 1) == 1.5
    assert settled(0, 0, 0, 1.001) == END
    assert settled(9, 9, 9, 9) == END


def test_what_is_not_finite_is_not_small() -> None:
    assert settled(0, np.nan, 0, 0) == 1.0
    assert settled(0, 0, 0, np.nan) == END
    assert settled(np.inf, 0, 0, 0) == 0.5


@given(arrays(float, (5, 4), elements=st.floats(-3, 3)))
def test_against_the_definition(error: np.ndarray) -> None:
    for found, series in zip(convergence_time(1.0, error, TIMES), error):
        small = [t for i, t in enumerate(TIMES) if (np.abs(series[i:]) <= 1).all()]
        assert found == (small[0] if small else END)


@given(arrays(float, (3, 4), elements=st.floats(-3, 3)), st.floats(0.1, 1), st.floats(1, 3))
def test_a_wider_limit_is_met_no_later(error: np.ndarray, narrow: float, wide: float) -> None:
    early, late = (convergence_time(limit, error, TIMES) for limit in (wide, narrow))
    assert (early <= late).all()
