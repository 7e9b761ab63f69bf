"""Overviews of a table: error over bound of every case and estimator, where to draw each mark."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from debrisest.results.runs import SIMULATED
from debrisest.vocabulary import TWO_SIDED, VOCABULARY

LEFT, PLOT, TOP = 92.0, 250.0, 20.0
"""Width of the names of cases, of what is drawn, and height of the title, px."""
_STEP, _BETWEEN = 5.0, 6.0
"""Height of a mark, and distance between cases, px."""
_LEAST = 2.0
"""An axis shows at least this factor to both sides of 1."""


class Mark(NamedTuple):
    """A figure: where it lies, where its interval begins and ends, and what it says."""

    colour: int
    x: float
    low: float
    high: float
    y: float
    words: str


class Panel(NamedTuple):
    """The figures of a quantity, statistic and window over a common reference."""

    title: str
    reference: str
    height: float
    ticks: list[tuple[float, str]]
    cases: list[tuple[float, str]]
    published: list[tuple[float, float, float]]
    """Where the published value of a case stands: x, and from which y to which."""
    marks: list[Mark]


def panels(cells: pd.DataFrame, estimators: Sequence[str]) -> Iterator[Panel]:
    """Yield an overview of each quantity, statistic and window that has a bound or a value.

    Errors are over their bound; where there is none, over the published value. Squares that are
    one in the mean if an estimator is consistent stand as they are.
    """
    shown = cells[(cells["estimator"] != SIMULATED) & ~cells["quantity"].isin(TWO_SIDED)]
    shown = shown.assign(**{"1": 1.0})
    for keys, part in shown.groupby(["quantity", "statistic", "window"], sort=False):
        square = VOCABULARY[str(keys[0])].chi_square is not None
        for reference in ("1",) if square else ("bound", "published"):
            known = part[(part[reference] > 0) & (part["measured"] > 0)]
            if len(known):
                yield _panel(known, ", ".join(map(str, keys)), reference, estimators)
                break


def _panel(cells: pd.DataFrame, title: str, reference: str, estimators: Sequence[str]) -> Panel:
    figures = cells[["measured", "ci_low", "ci_high", "published"]].astype(float)
    drawn = figures.div(cells[reference].astype(float), axis=0).to_numpy()
    low, high = _limits(drawn)
    here = [name for name in estimators if name in set(cells["estimator"])]
    height = _STEP * len(here) + _BETWEEN
    cases = list(dict.fromkeys(cells["case"]))
    marks, published = [], {}
    for (_, row), (x, begin, end, value) in zip(cells.iterrows(), drawn):
        top = TOP + height * cases.index(row["case"])
        y = top + _BETWEEN / 2 + _STEP * (here.index(row["estimator"]) + 0.5)
        ends = (each if np.isfinite(each) else x for each in (begin, end))
        at, first, last = (_place(each, low, high) for each in (x, *ends))
        words = f"{row['case']}, {row['estimator']}: {row['measured']:.3g} {row['unit']}, {x:.3g}"
        colour = estimators.index(row["estimator"])
        marks.append(Mark(colour, at, first, last, y, f"{words} x {reference}"))
        if np.isfinite(value):
            published[row["case"]] = (_place(value, low, high), top + 2, top + height - 2)
    names = [(TOP + height * (index + 0.5), str(name)) for index, name in enumerate(cases)]
    ticks = [(_place(tick, low, high), f"{tick:g}") for tick in _ticks(low, high)]
    full = TOP + height * len(cases) + 18
    return Panel(title, reference, full, ticks, names, list(published.values()), marks)


def _limits(values: np.ndarray) -> tuple[float, float]:
    known = values[np.isfinite(values) & (values > 0)]
    low, high = np.min(known, initial=1 / _LEAST), np.max(known, initial=_LEAST)
    return float(np.log10(low)) - 0.05, float(np.log10(high)) + 0.05


def _place(value: float, low: float, high: float) -> float:
    """Return where a value lies on the logarithmic axis, px; what it cannot show, at its left."""
    if not value > 0:
        return LEFT
    return round(LEFT + PLOT * (float(np.log10(value)) - low) / (high - low), 1)


def _ticks(low: float, high: float) -> list[float]:
    decades = range(int(np.floor(low)), int(np.ceil(high)) + 1)
    steps = (1, 2, 5) if high - low < 1.7 else (1,)
    found = [step * 10.0**decade for decade in decades for step in steps]
    return [tick for tick in found if low <= np.log10(tick) <= high]
