"""Arguments and options that several commands share."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

from typer import Argument, Option


class Format(StrEnum):
    """How tables are printed."""

    RICH = "rich"
    CSV = "csv"
    MD = "md"
    TEX = "tex"
    JSON = "json"


Configs = Annotated[
    list[Path],
    Argument(help="Scenario files (YAML), or names of shipped ones.", metavar="CONFIG..."),
]
Out = Annotated[Path, Option("--out", help="Folder of results.")]
Jobs = Annotated[int | None, Option("--jobs", min=1, help="Processes (default: all cores).")]
Runs = Annotated[int | None, Option("--runs", min=1, help="Runs per case.")]
Keep = Annotated[
    str | None,
    Option("--keep", metavar="N|all", help="Runs whose trajectories are kept (default: 1)."),
]
CaseNames = Annotated[list[str] | None, Option("--case", help="Only this case (repeatable).")]
EstimatorNames = Annotated[
    list[str] | None, Option("--estimator", help="Only this estimator (repeatable).")
]
Settings = Annotated[
    list[str] | None, Option("--set", help="key.path=value, laid on every case (repeatable).")
]
Variant = Annotated[
    str | None,
    Option("--variant", help="Keep results in DIR/SCENARIO@NAME (with --set by default)."),
]
Plugins = Annotated[
    list[Path] | None,
    Option("--plugin", metavar="FILE.py", help="Parts of your own (repeatable)."),
]
DryRun = Annotated[bool, Option("--dry-run", help="Tell what would run, and why.")]
Force = Annotated[bool, Option("--force", help="Run even what is up to date.")]
RerunFailed = Annotated[
    bool, Option("--rerun-failed", help="Run again what has runs that failed or diverged.")
]
Cluster = Annotated[
    str | None, Option("--executor", help="Run on a cluster: dask:tcp://HOST:PORT.")
]
WidestPx = Annotated[
    int, Option("--widest-px", min=64, help="Reduce images of one camera with more columns.")
]
Quiet = Annotated[bool, Option("--quiet", help="No progress.")]
Check = Annotated[bool, Option("--check", help="Exit 1 on unexpected verdicts.")]
Report = Annotated[
    bool, Option("--report", help="End with a report of HTML, as the command report makes it.")
]
Unprinted = Annotated[bool, Option("--quiet", help="Write files, print nothing about them.")]
Form = Annotated[Format, Option("--format", help="How to print.")]
RESULTS = Path("results")
