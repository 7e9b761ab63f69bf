"""Tables as text: for the terminal, Markdown, LaTeX, CSV and JSON."""

from collections.abc import Callable, Iterator
from typing import Literal

import pandas as pd
from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

from debrisest.scenario.load import LoadedScenario
from debrisest.show.tables.escapes import latex, markdown, paragraph
from debrisest.show.tables.layout import (
    DERIVED,
    Sheet,
    below_bound,
    sheets,
    with_ratio,
    without_bound,
)
from debrisest.show.tables.published import derived_values
from debrisest.show.tables.verdict import (
    CONSISTENCY,
    LEGEND,
    LEGEND_OF_BELOW,
    LEGEND_OF_CONSISTENCY,
    LEGEND_OF_INTERVALS,
    LEGEND_OF_LOST,
    LEGEND_OF_NO_BOUND,
    LEGEND_OF_RATIOS,
)
from debrisest.show.terminal import console

MARK = "written by debrisest"
"""What tells the files of tables from others of their name."""
_COLOURS = {
    "=": "green",
    "<": "cyan",
    ">": "red",
    "x": "magenta",
    "consistent": "green",
    "over-cautious": "cyan",
    "over-confident": "red",
    "not the minimum": "red",
}


def render(scenario: LoadedScenario, cells: pd.DataFrame, form: str) -> str:
    """Return the tables of a scenario in one of FORMS."""
    return FORMS[form](scenario, cells)


def render_all(tables: list[tuple[LoadedScenario, pd.DataFrame]], form: str) -> str:
    """Return the tables of several scenarios; in CSV and JSON a column tells them apart."""
    if len(tables) > 1 and form in ("csv", "json"):
        named = [cells.assign(scenario=scenario.name) for scenario, cells in tables]
        together = pd.concat(named, ignore_index=True)
        columns = ["scenario", *together.columns.drop("scenario")]
        return render(tables[0][0], together[columns], form)
    return "".join(render(scenario, cells, form) for scenario, cells in tables)


def _csv(_: LoadedScenario, cells: pd.DataFrame) -> str:
    return str(cells.to_csv(index=False, lineterminator="\n"))


def _json(_: LoadedScenario, cells: pd.DataFrame) -> str:
    return str(cells.to_json(orient="records", indent=1, double_precision=15)) + "\n"


def _markdown(scenario: LoadedScenario, cells: pd.DataFrame) -> str:
    common = scenario.common
    told = legends(scenario, cells, detail=True)
    parts = [f"# {markdown(common.title)}", paragraph(common.source), *told]
    for sheet in sheets(scenario, cells, detail=True):
        lines = [sheet.heads, ["---"] * len(sheet.heads), *sheet.rows]
        escaped = [[markdown(text) for text in line] for line in lines]
        body = "\n".join(f"| {' | '.join(line)} |" for line in escaped)
        parts.append(f"## Table {sheet.number}: {markdown(sheet.title)}\n\n{body}")
    return "\n\n".join(part for part in (*parts, f"<!-- {MARK} -->") if part) + "\n"


def legends(scenario: LoadedScenario, cells: pd.DataFrame, detail: bool = False) -> list[str]:
    """Return what explains the signs, the numbers in brackets and the words of these cells."""
    details = _legends_of_details(cells) if detail else []
    signs = [LEGEND] if cells["published"].notna().any() else []
    lost = [LEGEND_OF_LOST] if (cells["failed"] + cells["diverged"] > 0).any() else []
    words = [LEGEND_OF_CONSISTENCY] if cells["verdict"].isin(CONSISTENCY).any() else []
    made = "; ".join(dict.fromkeys(derived_values(scenario, cells).values()))
    derived = [f"{DERIVED} not printed so: {made}"] if made else []
    first = signs + lost + details
    return ["; ".join(first)] * bool(first) + derived + words


def _legends_of_details(cells: pd.DataFrame) -> list[str]:
    rated = with_ratio(cells).any()
    said = {
        LEGEND_OF_INTERVALS: cells["ci_low"].notna().any(),
        LEGEND_OF_RATIOS: rated,
        LEGEND_OF_BELOW: below_bound(cells).any(),
        LEGEND_OF_NO_BOUND: rated and without_bound(cells).any(),
    }
    return [legend for legend, needed in said.items() if needed]


def _latex(scenario: LoadedScenario, cells: pd.DataFrame) -> str:
    """Return floats with captions and labels, with the rules of the package booktabs."""
    told = legends(scenario, cells, detail=True)
    parts = ["\n".join(f"% {text}" for text in (scenario.common.title, *told))]
    for number, sheet in enumerate(sheets(scenario, cells, detail=True), 1):
        head, *rows = (
            " & ".join(latex(text) for text in line) + r" \\" for line in (sheet.heads, *sheet.rows)
        )
        columns = "".join("l" if head in ("case", "source") else "r" for head in sheet.heads)
        parts.append(
            "\\begin{table}\n"
            f"\\caption{{{latex(_caption(sheet, told))}}}\n"
            f"\\label{{tab:{scenario.name}-{number}}}\n"
            f"\\begin{{tabular}}{{{columns}}}\n\\toprule\n{head}\n\\midrule\n"
            + "\n".join(rows)
            + "\n\\bottomrule\n\\end{tabular}\n\\end{table}"
        )
    return "\n\n".join((*parts, f"% {MARK}")) + "\n"


def _caption(sheet: Sheet, told: list[str]) -> str:
    return ". ".join([f"Table {sheet.number}: {sheet.title}", *told])


def _terminal(scenario: LoadedScenario, cells: pd.DataFrame) -> str:
    """Return tables as wide as the terminal; figures have their intervals where these fit."""
    terminal, details = console(), False
    both = zip(sheets(scenario, cells), sheets(scenario, cells, detail=True))
    with terminal.capture() as capture:
        for plain, full in both:
            title = Text(f"\nTable {plain.number}: {plain.title}", style="bold")
            terminal.print(title, soft_wrap=True)
            fits = _fits(full, terminal)
            terminal.print(*([_rich_table(full)] if fits else _fitting(plain, terminal)))
            details |= fits
        for text in legends(scenario, cells, details):
            terminal.print(f"{text}\n", style="dim", soft_wrap=True, markup=False)
    return capture.get()


def _fits(sheet: Sheet, terminal: Console) -> bool:
    """Return whether a table needs no folding, which the widest text of each column tells."""
    widest = [max(column, key=cell_len) for column in zip(*sheet.rows)]
    table = _rich_table(sheet._replace(rows=[widest] if widest else []))
    free = terminal.options.update_width(10**4)
    return terminal.measure(table, options=free).maximum <= terminal.width


def _fitting(sheet: Sheet, terminal: Console) -> list[Table]:
    """Return the table; if it is too wide, with units below the names, then names in parts.

    If that is too wide as well, it is two tables of half the columns each, and so on.
    """
    below = [head.replace(" (", "\n(").replace(", ", ",\n") for head in sheet.heads]
    parts = [head.replace("_", "_\n") for head in below]
    forms = [sheet._replace(heads=heads) for heads in (sheet.heads, below, parts)]
    fitting = next((form for form in forms if _fits(form, terminal)), None)
    named = 2 if "source" in sheet.heads else 1
    middle = (named + len(sheet.heads) + 1) // 2
    if fitting or len(sheet.heads) < named + 2:
        return [_rich_table(fitting or forms[-1], folded=fitting is None)]
    halves = (slice(named, middle), slice(middle, None))
    return [table for half in halves for table in _fitting(_columns(sheet, named, half), terminal)]


def _columns(sheet: Sheet, named: int, chosen: slice) -> Sheet:
    """Return a sheet with the columns that name its rows, and some of the others."""
    heads, *rows = ([*row[:named], *row[chosen]] for row in (sheet.heads, *sheet.rows))
    return sheet._replace(heads=heads, rows=[row for row in rows if any(row[named:])])


def _rich_table(sheet: Sheet, folded: bool = False) -> Table:
    """Return a table; unless cells are folded, a column is one text, laid out at once."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for head in sheet.heads:
        side: Literal["left", "right"] = "left" if head in ("case", "source") else "right"
        whole = head in ("case", "source")
        table.add_column(Text(head), justify=side, overflow="fold", no_wrap=whole)
    rows = list(_shown(sheet))
    columns = [Text("\n").join(column) for column in zip(*rows)]
    for row in rows if folded else [columns] * bool(rows):
        table.add_row(*row)
    return table


def _shown(sheet: Sheet) -> Iterator[list[Text]]:
    """Yield the rows; of those of one case, the first has its name."""
    previous = ""
    for row in sheet.rows:
        named = "" if row[0] == previous and "source" in sheet.heads else row[0]
        yield [_coloured(text) for text in (named, *row[1:])]
        previous = row[0]


def _coloured(text: str) -> Text:
    colour = _COLOURS.get(text.rpartition(" ")[2]) if " " in text else None
    return Text(text, style=colour or "")


FORMS: dict[str, Callable[[LoadedScenario, pd.DataFrame], str]] = {
    "rich": _terminal,
    "csv": _csv,
    "md": _markdown,
    "tex": _latex,
    "json": _json,
}
