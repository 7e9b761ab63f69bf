"""A comparison as text: what differs first, then the cells."""

from collections.abc import Hashable, Iterator, Mapping
from typing import Any, Literal

import pandas as pd
from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from debrisest.show.compare.sides import Comparison
from debrisest.show.terminal import console

_STYLES = {"lower": "cyan", "higher": "red"}
_GROUPED = ["table", "first_estimator", "second_estimator", "statistic", "window"]
_NUMBERS = ("first", "second", "ratio", "second - first, 95 %")
_HEADS = ("case", "quantity", *_NUMBERS, "")


def render_comparison(found: Comparison, settings: list[str], rows: pd.DataFrame) -> str:
    """Return a comparison for the terminal."""
    terminal = console()
    with terminal.capture() as capture:
        for name, side in (("first", found.first), ("second", found.second)):
            terminal.print(Text(f"{name}: {side.results.folder}"), soft_wrap=True)
        terminal.print(Text("\nWhat differs in the scenario, first -> second", style="bold"))
        for line in settings or ["nothing"]:
            terminal.print(Text(f"  {line}"), soft_wrap=True)
        for keys, part in rows.groupby(_GROUPED, sort=False):
            name, mine, other, statistic, window = map(str, keys)
            of = " -> ".join(dict.fromkeys((mine, other)))
            title = f"\nTable {name}: {of}, {statistic}, {window}"
            terminal.print(Text(title, style="bold"), soft_wrap=True)
            terminal.print(_table(part))
        for line in summary(rows):
            terminal.print(Text(line), soft_wrap=True)
    return capture.get()


def summary(rows: pd.DataFrame) -> list[str]:
    """Return how many cells say what, how runs were paired, and what pairing is worth."""
    said = [f"{count} {word}" for word, count in rows["said"].value_counts(sort=False).items()]
    told = [f"{len(rows)} cells, the second against the first: {', '.join(said)}"]
    for pairing, part in rows.groupby("pairing", sort=False):
        told.append(f"{pairing} ({len(part)} cells){_worth(part)}")
    return told


def _worth(rows: pd.DataFrame) -> str:
    width, apart = (rows[f"{high}_high"] - rows[f"{high}_low"] for high in ("ci", "unpaired"))
    ratios = (apart / width)[width > 0]
    if ratios.empty:
        return ""
    return f"; unpaired, intervals were {ratios.median():.2g} times as wide in the median"


def _table(rows: pd.DataFrame) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for head in _HEADS:
        side: Literal["left", "right"] = "right" if head in _NUMBERS else "left"
        table.add_column(head, justify=side, overflow="fold", no_wrap=head in _NUMBERS)
    previous = ""
    for row in rows.to_dict("records"):
        case = str(row["case"])
        table.add_row(Text("" if case == previous else case), *_cells(row))
        previous = case
    return table


def _cells(row: Mapping[Hashable, Any]) -> Iterator[Text]:
    """Yield what stands in a row after its case."""
    yield Text(row["quantity"] if row["unit"] == "1" else f"{row['quantity']} ({row['unit']})")
    yield from (Text(f"{row[name]:.3g}") for name in ("first", "second", "ratio"))
    yield Text(f"[{row['ci_low']:+.2g}, {row['ci_high']:+.2g}]")
    left_out = row["first_left_out"], row["second_left_out"]
    lost = "; left out: {} + {} runs".format(*left_out) if any(left_out) else ""
    yield Text(f"{row['said']}{lost}", style=_STYLES.get(row["said"], ""))
