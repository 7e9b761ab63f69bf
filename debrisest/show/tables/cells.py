"""The cells of a scenario's tables: measured figures beside published values."""

from collections.abc import Callable, Hashable, Mapping
from functools import cache, partial
from typing import Any, TypeAlias

import numpy as np
import pandas as pd

from debrisest.assessment.consistency import consistent_interval
from debrisest.assessment.intervals import with_interval
from debrisest.results.figured import AllRuns
from debrisest.results.runs import SIMULATED, Runs
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.table_keys import Table, Tables
from debrisest.show.tables.figures import DOUBT, dataset_of, figures, keys_of, unit_of
from debrisest.show.tables.published import CellKey, Published, published_values
from debrisest.show.tables.verdict import (
    Verdict,
    consistency,
    interval_agrees,
    interval_meets,
    verdict,
)
from debrisest.vocabulary import TWO_SIDED, VOCABULARY

_DOUBTFUL_BOUND = 0.05
"""Share of runs by which a bound is none."""
COLUMNS = [
    *("table", "case", "estimator", "quantity", "unit", "statistic", "window"),
    *("published", "measured", "ci_low", "ci_high", "bound"),
    *("runs", "failed", "diverged", "verdict", "consistent_low", "consistent_high"),
]


Row: TypeAlias = dict[str, Any]
"""A cell, by COLUMNS."""


def cells(scenario: LoadedScenario, results: AllRuns) -> pd.DataFrame:
    """Return one row per cell as ``rows_of`` does, as ``framed`` does."""
    return framed(scenario, rows_of(scenario, results))


def rows_of(scenario: LoadedScenario, results: AllRuns) -> list[Row]:
    """Return one row per cell, in the order of the layout, then case, estimator, quantity."""
    published = published_values(scenario)
    rows = (
        _row(key, estimator, table, scenario, results, measured, published.get(key))
        for table in scenario.common.tables.layout
        for measured in [cache(partial(_measured, table, scenario.common.tables, results))]
        for key, estimator in keys_of(
            table, scenario.common.tables, scenario.cases, scenario.common.estimators
        )
    )
    return [row for row in rows if row is not None]


def framed(scenario: LoadedScenario, rows: list[Row]) -> pd.DataFrame:
    """Return rows as a frame.

    The values of a grid have a column each, the last ones, by the paths of their keys.
    """
    found = pd.DataFrame(rows, columns=COLUMNS)
    for key in dict.fromkeys(key for values in scenario.grid.values() for key in values):
        found[key] = [scenario.grid.get(case, {}).get(key) for case in found["case"]]
    return found


def unexpected(
    scenario: LoadedScenario, rows: pd.DataFrame, asked: Callable[[str, str], bool]
) -> list[str]:
    """Return a sentence for each cell that is asked for and is not there, or not as expected."""
    found = []
    present = {
        (CellKey(*(row[field] for field in CellKey._fields)), row["estimator"]): row
        for row in rows.to_dict("records")
    }
    for key, entry in published_values(scenario).items():
        for estimator, expected in entry.expected.items():
            if not asked(key.case, estimator):
                continue
            row = present.get((key, estimator))
            said = "no result" if row is None else _disagreement(row, entry, expected)
            if said:
                found.append(
                    f"Table {key.table}, case {key.case}, {estimator}, {key.quantity} "
                    f"({key.statistic}, {key.window}): {said}, expected {' or '.join(expected)}"
                )
    return found


def _disagreement(row: Mapping[Hashable, Any], entry: Published, expected: list[Verdict]) -> str:
    """Return what speaks against the expected verdicts: not the cell, nor its interval."""
    interval = row["ci_low"], row["ci_high"]
    consistent = row["consistent_low"], row["consistent_high"]
    if entry.value is None:
        against = f"{consistent[0]:.4g} to {consistent[1]:.4g}"
        meets = any(interval_agrees(v, interval, consistent) for v in expected)
    else:
        against = f"{entry.value:.4g}"
        meets = any(interval_meets(v, *interval, entry.value, entry.factor) for v in expected)
    if row["verdict"] in expected or meets:
        return ""
    return (
        f"{row['verdict']}, {row['measured']:.4g} [{row['ci_low']:.4g}, {row['ci_high']:.4g}] "
        f"against {against}"
    )


def _row(
    key: CellKey,
    estimator: str,
    table: Table,
    scenario: LoadedScenario,
    results: AllRuns,
    measured: Callable[[CellKey, str], dict[str, Any] | None],
    published: Published | None,
) -> Row | None:
    found = measured(key, estimator)
    if found is None:
        return None
    bound = None
    if estimator != SIMULATED:
        name = scenario.common.estimators[estimator].bound
        if _is_bound(results.get((key.case, name))):
            bound = measured(key, name)
    return {
        **key._asdict(),
        "estimator": estimator,
        "unit": unit_of(table, key.quantity),
        "published": published.value if published else None,
        **found,
        "bound": bound["measured"] if bound else np.nan,
        "verdict": str(_said(key.quantity, found, published)),
    }


def _is_bound(found: Runs | None) -> bool:
    """Return whether most runs of a bound say that it is none, so that it is not shown."""
    if found is None or not found.shows(DOUBT.dataset):
        return True
    doubt = found.figures(*DOUBT)[found.good]
    return bool(np.mean(doubt > 0.0) <= _DOUBTFUL_BOUND) if len(doubt) else True


def _said(quantity: str, found: Mapping[str, Any], published: Published | None) -> Verdict:
    lost = (found["diverged"] + found["failed"]) / found["runs"]
    if published is None or published.value is None:
        interval = found["consistent_low"], found["consistent_high"]
        chi_square = VOCABULARY[quantity].chi_square
        of_costs = chi_square is not None and chi_square.of_costs
        return consistency(found["measured"], *interval, lost, of_costs)
    said = verdict(found["measured"], published.value, published.factor, lost)
    off = quantity in TWO_SIDED and said in (Verdict.BETTER, Verdict.WORSE)
    return Verdict.NOT_REPRODUCED if off else said


def _measured(
    table: Table, tables: Tables, results: AllRuns, key: CellKey, estimator: str
) -> dict[str, Any] | None:
    """Return the figure of a cell with its interval and its runs, or None if it is not there."""
    dataset = dataset_of(table, key.quantity)
    parts = [results.get((case, estimator)) for case in tables.means.get(key.case, [key.case])]
    present = [part for part in parts if part is not None and part.shows(dataset)]
    if not present or len(present) < len(parts):
        return None
    freedom = [part.freedom(dataset, key.statistic, key.window) for part in present]
    if not any(part.seen(dataset, key.window) for part in present):
        return None
    groups = [figures(part, key, table, tables) for part in present]
    kept = [values[keep] for values, keep, _ in groups]
    free = [degrees[keep] for degrees, (_, keep, _) in zip(freedom, groups)]
    measured, low, high = (_rounded(x) for x in with_interval(key.statistic, kept))
    consistent = [_rounded(x) for x in consistent_interval(key.statistic, free)]
    return {
        "measured": measured,
        "ci_low": low,
        "ci_high": high,
        "runs": sum(part.runs for part in present),
        "failed": sum(len(part.failures) for part in present),
        "diverged": sum(int(lost.sum()) for *_, lost in groups),
        "consistent_low": consistent[0],
        "consistent_high": consistent[1],
    }


def _rounded(value: float) -> float:
    """Keep six digits, so that the last bits of a sum never show in a table."""
    return float(f"{value:.6g}")
