"""The command about single files of results: rerun."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from debrisest.cli.exits import exit_if
from debrisest.cli.options import Plugins


def rerun(
    files: Annotated[list[Path], Argument(help="Files of results.", metavar="FILE.h5...")],
    export: Annotated[
        bool, Option("--export", help="Print the stored scenario (YAML), run nothing.")
    ] = False,
    plugins: Plugins = None,
) -> None:
    """Compute files of results again from what they store: are the bytes the same?"""
    from debrisest.plugins.load import read_plugins
    from debrisest.runner import rerun as runner

    own_parts = read_plugins(plugins or ())
    differ = False
    for path in files:
        if export:
            print(runner.stored_scenario(path), end="")
            continue
        found = runner.rerun(path, own_parts)
        told = "different bytes" if found.differing else "same bytes"
        print(f"{path}: {told} ({found.name}, {found.datasets} datasets)")
        since = [f"since then: {found.since}"] * bool(found.since)
        for sentence in (*since, *found.differing):
            print(f"  {sentence}")
        differ |= bool(found.differing)
    exit_if(differ)
