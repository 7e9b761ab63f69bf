"""What is said of a figure beside a published one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.show.tables.verdict import SYMBOLS, Verdict, consistency, interval_meets, verdict

positive = st.floats(1e-3, 1e3)
factors = st.floats(1.01, 10)


@pytest.mark.parametrize(
    ("measured", "expected"),
    [
        (0.4999, "better"),
        (0.5, "reproduced"),
        (1.0, "reproduced"),
        (2.0, "reproduced"),
        (2.0001, "worse"),
        (0.0, "better"),
        (np.nan, "not reproduced"),
        (np.inf, "not reproduced"),
    ],
)
def test_the_band_includes_its_edges(measured: float, expected: str) -> None:
    assert verdict(measured, 1.0, 2.0, 0.0) == expected


@pytest.mark.parametrize(
    ("lost", "expected"),
    [(0.0, "reproduced"), (0.5, "reproduced"), (0.5001, "not reproduced"), (1, "not reproduced")],
)
def test_more_than_half_the_runs_lost(lost: float, expected: str) -> None:
    assert verdict(1.0, 1.0, 2.0, lost) == expected


@given(positive, positive, factors, positive)
def test_the_unit_does_not_matter(
    measured: float, published: float, factor: float, k: float
) -> None:
    ratio = measured / published
    if min(abs(ratio * factor - 1), abs(ratio / factor - 1)) > 1e-9:
        scaled = verdict(k * measured, k * published, factor, 0.0)
        assert scaled == verdict(measured, published, factor, 0.0)


@given(positive, positive, factors)
def test_better_and_worse_are_mirrored(measured: float, published: float, factor: float) -> None:
    mirrored = {"better": "worse", "worse": "better", "reproduced": "reproduced"}
    ratio = measured / published
    if min(abs(ratio * factor - 1), abs(ratio / factor - 1)) > 1e-9:
        said = verdict(measured, published, factor, 0.0)
        assert verdict(published, measured, factor, 0.0) == mirrored[said]


@pytest.mark.parametrize(
    ("expected", "low", "high", "meets"),
    [
        (Verdict.REPRODUCED, 0.8, 1.2, True),
        (Verdict.REPRODUCED, 1.9, 5.0, True),
        (Verdict.REPRODUCED, 2.0, 5.0, True),
        (Verdict.REPRODUCED, 2.1, 5.0, False),
        (Verdict.REPRODUCED, 0.1, 0.5, True),
        (Verdict.REPRODUCED, 0.1, 0.4, False),
        (Verdict.REPRODUCED, 0.1, 9.0, True),
        (Verdict.BETTER, 0.4, 0.9, True),
        (Verdict.BETTER, 0.5, 0.9, False),
        (Verdict.WORSE, 1.0, 2.1, True),
        (Verdict.WORSE, 1.0, 2.0, False),
        (Verdict.NOT_REPRODUCED, 0.0, 9.0, False),
        (Verdict.UNPUBLISHED, 0.0, 9.0, False),
        (Verdict.REPRODUCED, np.nan, np.nan, False),
    ],
)
def test_an_interval_meets_a_band(expected: Verdict, low: float, high: float, meets: bool) -> None:
    assert interval_meets(expected, low, high, 1.0, 2.0) is meets


@given(positive, positive, factors)
def test_an_interval_meets_the_verdict_of_each_figure_in_it(
    measured: float, published: float, factor: float
) -> None:
    said = verdict(measured, published, factor, 0.0)
    assert interval_meets(said, 0.9 * measured, 1.1 * measured, published, factor)


def test_every_verdict_has_a_symbol_of_its_own() -> None:
    assert SYMBOLS.keys() == set(Verdict)
    assert len(set(SYMBOLS.values())) == len(Verdict)


@pytest.mark.parametrize(
    ("measured", "expected"),
    [
        (0.7999, "over-cautious"),
        (0.8, "consistent"),
        (1.2, "consistent"),
        (1.2001, "over-confident"),
        (np.inf, "unpublished"),
        (np.nan, "unpublished"),
    ],
)
def test_consistency_in_words(measured: float, expected: str) -> None:
    assert consistency(measured, 0.8, 1.2, 0.5) == expected
    assert consistency(measured, 0.8, 1.2, 0.5001) == "unpublished"
    assert consistency(measured, np.nan, np.nan, 0.0) == "unpublished"
