"""All commands by name."""

import os
import sys
from collections.abc import Callable
from io import TextIOWrapper
from typing import Annotated

import typer

from debrisest import __version__
from debrisest.cli import (
    compare,
    estimate,
    estimates,
    measured,
    reconstruct,
    render,
    report,
    rerun,
    scenarios,
    show,
    stages,
    track,
)
from debrisest.cli.exits import Commands
from debrisest.files import remove_own
from debrisest.interrupts import before_end

for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")
for _variable in ("COLUMNS", "LINES", "SOURCE_DATE_EPOCH"):
    _given = os.environ.get(_variable, "0")
    if not _given.isdecimal() or len(_given) > 10:  # what rich, numpy and matplotlib trace at
        del os.environ[_variable]
for _variable in ("HDF5_DRIVER", "HDF5_VOL_CONNECTOR"):  # a wrong one ends HDF5 by a signal
    os.environ.pop(_variable, None)

COMMANDS: dict[str, Callable[..., None]] = {
    "simulate": stages.simulate,
    "recover": stages.recover,
    "filter": stages.filter,
    "sweep": stages.sweep,
    "table": show.table,
    "plot": show.plot,
    "status": show.status,
    "rerun": rerun.rerun,
    "report": report.report,
    "compare": compare.compare,
    "estimate": estimate.estimate,
    "estimates": estimates.estimates,
    "render": render.render,
    "track": track.track,
    "reconstruct": reconstruct.reconstruct,
    "validate": scenarios.validate,
    "schema": scenarios.schema,
    "init": scenarios.init,
    "import": measured.import_,
}

app = typer.Typer(
    name="debrisest",
    cls=Commands,
    rich_markup_mode=None,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
for _name, _command in COMMANDS.items():
    app.command(_name)(_command)


def _tell_version(asked: bool) -> None:
    if asked:
        print(f"debrisest {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="The version.")
    ] = False,
) -> None:
    """Batch experiments on estimating the motion of tumbling space debris from vision."""


def main() -> None:
    """Run the command line, whose texts may have signs that the terminal has not."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    before_end(remove_own)
    app()
