"""The differences of each cell that both sides have."""

import zlib
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from debrisest.arrays import Array
from debrisest.assessment.paired import FEWEST, difference
from debrisest.results.runs import SIMULATED, Runs
from debrisest.scenario.table_keys import Table
from debrisest.show.compare.sides import Comparison, Pairing
from debrisest.show.tables.figures import dataset_of, figures, keys_of, unit_of
from debrisest.show.tables.published import CellKey

COLUMNS = [
    *("table", "case", "first_estimator", "second_estimator"),
    *("quantity", "unit", "statistic", "window", "first", "second", "ratio"),
    *("difference", "ci_low", "ci_high", "unpaired_low", "unpaired_high"),
    *("runs", "first_left_out", "second_left_out", "pairing", "said"),
]
"""Differences are the second minus the first. ``runs`` are those that count, on both sides."""
LOWER, HIGHER, OPEN, FEW = "lower", "higher", "undecided", "too few runs"


def compared(found: Comparison) -> pd.DataFrame:
    """Return one row per cell of the first side's tables that is there on both sides."""
    pairs = {(case, mine): other for case, mine, other in found.pairs()}
    cases = list(dict.fromkeys(case for case, _ in pairs))
    estimators = [name for name in dict.fromkeys(name for _, name in pairs) if name != SIMULATED]
    tables = found.first.tables
    rows = [
        row
        for table in tables.layout
        for key, mine in keys_of(table, tables, cases, estimators)
        if (row := _row(found, table, key, mine, pairs)) is not None
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def _row(
    found: Comparison,
    table: Table,
    key: CellKey,
    mine: str,
    pairs: dict[tuple[str, str], str],
) -> dict[str, Any] | None:
    members = found.first.tables.means.get(key.case, [key.case])
    dataset = dataset_of(table, key.quantity)
    if not all((case, mine) in pairs for case in members):
        return None
    other = pairs[members[0], mine]
    parts = [
        (found.first.figured[case, mine], found.second.figured[case, other]) for case in members
    ]
    if not all(part.has(dataset) for both in parts for part in both):
        return None
    pairing = _weakest(found.pairing(case, mine, other) for case in members)
    groups = [_counted(found, table, key, both, pairing is not Pairing.NONE) for both in parts]
    return {
        **key._asdict(),
        "first_estimator": mine,
        "second_estimator": other,
        "unit": unit_of(table, key.quantity),
        **_figures(key, mine, groups, pairing),
        **{
            f"{side}_left_out": sum(both[index].runs for both in parts)
            - sum(len(group[index]) for group in groups)
            for index, side in enumerate(("first", "second"))
        },
    }


def _weakest(pairings: Iterator[Pairing]) -> Pairing:
    return max(pairings, key=list(Pairing).index)


def _counted(
    found: Comparison, table: Table, key: CellKey, both: tuple[Runs, Runs], paired: bool
) -> tuple[Array, Array]:
    """Return the figures (run,) of both sides that count; of pairs, those that count on both."""
    tables = found.first.tables
    (one, kept, _), (two, also, _) = (figures(part, key, table, tables) for part in both)
    if paired:
        runs = min(len(one), len(two))
        kept = also = kept[:runs] & also[:runs]
        one, two = one[:runs], two[:runs]
    return one[kept], two[also]


def _figures(
    key: CellKey, mine: str, groups: Sequence[tuple[Array, Array]], pairing: Pairing
) -> dict[str, Any]:
    first, second = zip(*groups)
    seed = zlib.crc32("|".join((*key, mine)).encode())
    apart = difference(key.statistic, first, second, False, seed)
    shown = apart
    if pairing is not Pairing.NONE:
        shown = difference(key.statistic, first, second, True, seed)
    runs = min(sum(map(len, first)), sum(map(len, second)))
    return {
        "first": shown.first,
        "second": shown.second,
        "ratio": shown.second / shown.first if shown.first else np.nan,
        "difference": shown.second - shown.first,
        "ci_low": shown.low,
        "ci_high": shown.high,
        "unpaired_low": apart.low,
        "unpaired_high": apart.high,
        "runs": runs,
        "pairing": str(pairing),
        "said": _said(shown.low, shown.high, runs),
    }


def _said(low: float, high: float, runs: int) -> str:
    if runs < FEWEST or not np.isfinite([low, high]).all():
        return FEW
    if low == high == 0.0:
        return "equal"
    return LOWER if high < 0.0 else HIGHER if low > 0.0 else OPEN
