"""Tables of estimates as text: for the terminal, CSV and JSON."""

from collections.abc import Callable, Sequence

import pandas as pd
from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

from debrisest.show.estimates import OF_ROW, Estimate
from debrisest.show.rounding import rounded
from debrisest.show.terminal import console


def render_estimates(found: Sequence[tuple[str, Estimate]], form: str) -> str:
    """Return estimates, each with the name of its scenario, in one of FORMS."""
    return FORMS[form](found)


def _frame(found: Sequence[tuple[str, Estimate]]) -> pd.DataFrame:
    """Return all rows; failed runs have none."""
    parts = [
        one.rows.assign(
            scenario=name,
            case=one.case,
            estimator=one.estimator,
            run=one.run,
            status=one.status,
        )
        for name, one in found
    ]
    columns = ["scenario", "case", "estimator", "run", *OF_ROW, "status"]
    parts = [part for part in parts if len(part)]
    return pd.concat(parts, ignore_index=True)[columns] if parts else pd.DataFrame(columns=columns)


def _csv(found: Sequence[tuple[str, Estimate]]) -> str:
    return str(_frame(found).to_csv(index=False, lineterminator="\n"))


def _json(found: Sequence[tuple[str, Estimate]]) -> str:
    return str(_frame(found).to_json(orient="records", indent=1, double_precision=15)) + "\n"


def _terminal(found: Sequence[tuple[str, Estimate]]) -> str:
    terminal = console()
    with terminal.capture() as capture:
        for name, one in found:
            where = f"{name} {one.case}, {one.estimator}, run {one.run}, at {one.time:g} s"
            terminal.print(f"\n[bold]{escape(f'Estimates: {where}')}[/]", soft_wrap=True)
            terminal.print(escape(one.status), soft_wrap=True)
            if len(one.rows):
                terminal.print(_table(one.rows))
    return capture.get()


def _table(rows: pd.DataFrame) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for head in ("quantity", "component", "value", "1 sigma", "unit"):
        table.add_column(head, justify="right" if head in ("value", "1 sigma") else "left")
    previous = ""
    for name, component, value, sigma, unit in rows[[*OF_ROW[1:]]].itertuples(index=False):
        figure, spread = rounded(value, sigma)
        shown = "" if name == previous else name
        table.add_row(*map(escape, (shown, component, figure or "undefined", spread, unit)))
        previous = name
    return table


FORMS: dict[str, Callable[[Sequence[tuple[str, Estimate]]], str]] = {
    "rich": _terminal,
    "csv": _csv,
    "json": _json,
}
