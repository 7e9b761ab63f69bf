"""The commands about scenario files: validate, schema, init."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from debrisest.cli.inputs import load_all
from debrisest.cli.options import Configs, Plugins, Settings


def validate(configs: Configs, settings: Settings = None, plugins: Plugins = None) -> None:
    """Check scenario files and tell every problem with its line."""
    for scenario in load_all(configs, settings, plugins):
        estimators = ", ".join(scenario.common.estimators)
        print(f"{scenario.path}: {len(scenario.cases)} cases, estimators: {estimators}")


def schema(plugins: Plugins = None) -> None:
    """Print the JSON schema of scenario files, for editors."""
    print(_schema(plugins), end="")


def _schema(plugins: list[Path] | None = None) -> str:
    import json

    from debrisest import notebook

    return json.dumps(notebook.schema(plugins or ()), indent=1) + "\n"


def init(
    name: Annotated[str | None, Argument(help="A shipped scenario.", metavar="[NAME]")] = None,
    force: Annotated[bool, Option("--force", help="Replace files that are there.")] = False,
) -> None:
    """Write a scenario to start from, or a shipped one with its published values.

    The JSON schema that its first line names for editors comes with it.
    """
    from debrisest.files import put
    from debrisest.shipped import SCHEMA, STARTER, copy_shipped, shipped_names

    written = copy_shipped(name or STARTER, Path(), force)
    put(Path(SCHEMA), _schema().encode())
    for path in [*written, Path(SCHEMA)]:
        print(f"wrote {path}")
    print(f"next: debrisest sweep {written[0]} --runs 5")
    if name is None:
        print(f"shipped scenarios (debrisest init NAME): {', '.join(shipped_names())}")
