"""The command that sets two results beside each other."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

Folders = Annotated[
    list[Path],
    Argument(help="One or two folders of results, such as results/biondi2017.", metavar="A [B]"),
]
Names = Annotated[
    list[str] | None,
    Option("--estimator", help="One: only this; two: the first's against the second's."),
]


class ComparisonFormat(StrEnum):
    """How a comparison is printed."""

    RICH = "rich"
    CSV = "csv"
    JSON = "json"


def compare(
    folders: Folders,
    estimator: Names = None,
    case: Annotated[
        list[str] | None, Option("--case", help="Only this case or mean (repeatable).")
    ] = None,
    form: Annotated[
        ComparisonFormat, Option("--format", help="How to print.")
    ] = ComparisonFormat.RICH,
) -> None:
    """Tell what differs between two results, or between two estimators of one.

    What differs in the scenario comes first, then each cell of the tables with the interval of its
    difference, of pairs of runs where both sides had the same draws.
    """
    from debrisest.errors import UserError, allowed_names
    from debrisest.show.compare.cells import compared
    from debrisest.show.compare.render import render_comparison
    from debrisest.show.compare.settings import different_settings
    from debrisest.show.compare.sides import comparison

    found = comparison(folders, estimator or [])
    rows = compared(found)
    known = dict.fromkeys(rows["case"])
    unknown = [
        f"--case {name}: {allowed_names(name, known)}" for name in case or () if name not in known
    ]
    if unknown:
        raise UserError(unknown)
    rows = rows[rows["case"].isin(case or known)]
    if form is ComparisonFormat.RICH:
        print(render_comparison(found, different_settings(found), rows), end="")
    elif form is ComparisonFormat.CSV:
        print(rows.to_csv(index=False, lineterminator="\n"), end="")
    else:
        print(rows.to_json(orient="records", indent=1, double_precision=15))
