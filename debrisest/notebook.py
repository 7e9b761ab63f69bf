"""The calls of a notebook: what the commands do, in this process, with values for files."""

import json
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from debrisest.errors import UserError
from debrisest.plugins.load import load_plugins, read_plugins
from debrisest.runner.plan import Selection, check_selection, plan
from debrisest.runner.sweep import Machine, bring_up_to_date
from debrisest.scenario.load import LoadedScenario, load_scenario
from debrisest.scenario.schema import ScenarioFile, scenario_model
from debrisest.shipped import scenario_path
from debrisest.show.tables.published import check_published
from debrisest.show.tables.tabulate import chosen, tabulate, write_tables


def load(
    config: str | Path, /, plugins: Iterable[str | Path] = (), **settings: Any
) -> LoadedScenario:
    """Return a scenario, by its file or the name of a shipped one, with settings laid on it.

    A setting is a key with its value; ``**{"motion.rate_deg_s": [8, 1, 4]}`` reaches inner keys.
    Raises UserError with every problem of the file.
    """
    own_parts = read_plugins(map(Path, plugins))
    overrides = [
        f"{key}={json.dumps(value, default=_plain, ensure_ascii=False)}"
        for key, value in settings.items()
    ]
    return load_scenario(scenario_path(Path(config)), overrides, own_parts)


def run(
    scenario: LoadedScenario | str | Path,
    out: str | Path = "results",
    *,
    jobs: int = 1,
    runs: int | None = None,
    cases: Sequence[str] | None = None,
    estimators: Sequence[str] | None = None,
    force: bool = False,
    quiet: bool = True,
) -> pd.DataFrame:
    """Bring a scenario up to date and write its tables; return what is asked for of the cells.

    The columns are those of ``tables.csv``. Runs that failed or diverged are counted there. Tables
    of measured data hold what needs no truth, which may be nothing.
    Raises UserError for wrong input, as the command does.
    """
    if not isinstance(scenario, LoadedScenario):
        scenario = load(scenario)
    selection = Selection(runs, cases, estimators, force=force)
    check_selection([scenario], selection)
    check_published(scenario)
    bring_up_to_date([scenario], Path(out), selection, Machine(jobs, quiet=quiet))
    rows, _ = tabulate(scenario, Path(out), plan(scenario, Path(out), Selection(runs)))
    if rows.empty and scenario.common.measured is None:
        raise UserError(f"{scenario.name}: there are no tables, since no step gave a result")
    if not rows.empty:
        write_tables(scenario, Path(out), rows)
    means = scenario.common.tables.means
    return chosen(rows, partial(selection.asks_for, means=means))


def schema(plugins: Iterable[str | Path] = ()) -> dict[str, Any]:
    """Return the JSON schema of scenario files."""
    load_plugins(read_plugins(map(Path, plugins)))
    found: dict[str, Any] = scenario_model(ScenarioFile).model_json_schema()
    return found


def _plain(value: Any) -> Any:
    """Return an array or a path as JSON knows it."""
    return value.tolist() if hasattr(value, "tolist") else str(value)
