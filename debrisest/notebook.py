"""The calls of a notebook: what the commands do, in this process, with values for files."""

import json
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from debrisest.batch.estimate import (
    estimate_from_attitudes,
    estimate_from_points,
    estimate_from_rates,
)
from debrisest.batch.motion import Motion
from debrisest.errors import UserError
from debrisest.measured.arrays import require_fitting
from debrisest.plugins.load import load_plugins, read_plugins
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection, check_selection
from debrisest.runner.sweep import Machine, bring_up_to_date
from debrisest.scenario.described import described
from debrisest.scenario.load import LoadedScenario, load_scenario
from debrisest.scenario.models import scenario_model
from debrisest.scenario.schema import ScenarioFile
from debrisest.scenario.variant import variant_called
from debrisest.shipped import scenario_path
from debrisest.show.tables.published import check_published
from debrisest.show.tables.tabulate import chosen, read_by_tables, tabulate, write_tables

_MOST_REASONS = 3


def load(
    config: str | Path,
    /,
    plugins: Iterable[str | Path] = (),
    variant: str | None = None,
    **settings: Any,
) -> LoadedScenario:
    """Return a scenario, by its file or the name of a shipped one, with settings laid on it.

    A setting is a key with its value; ``**{"motion.rate_deg_s": [8, 1, 4]}`` reaches inner keys.
    With settings it is a variant, whose results have a folder of their own, by the name ``variant``
    or one made of the settings. Raises UserError with every problem of the file.
    """
    own_parts = read_plugins(map(Path, plugins))
    overrides = [
        f"{key}={json.dumps(value, default=_plain, ensure_ascii=False)}"
        for key, value in settings.items()
    ]
    scenario = load_scenario(scenario_path(Path(config)), overrides, own_parts)
    name = variant_called(variant, overrides)
    return scenario.called(name) if name else scenario


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
    failures = bring_up_to_date([scenario], Path(out), selection, Machine(jobs, quiet=quiet))
    wanted = plan(scenario, Path(out), Selection(runs), read_by_tables(scenario))
    rows, _ = tabulate(scenario, Path(out), wanted)
    if rows.empty and scenario.common.measured is None:
        why = [f"{name} failed: {reason}" for name, reason in failures.items()]
        told = f"{scenario.name}: there are no tables, since no step gave a result"
        raise UserError([*why[:_MOST_REASONS], told])
    if not rows.empty:
        write_tables(scenario, Path(out), rows)
    means = scenario.common.tables.means
    return chosen(rows, partial(selection.asks_for, means=means))


def estimate(
    times: ArrayLike,
    *,
    points: ArrayLike | None = None,
    q: ArrayLike | None = None,
    rates: ArrayLike | None = None,
    sigma: ArrayLike | None = None,
    model: ArrayLike | None = None,
) -> Motion:
    """Return the motion of a tumbling body from one kind of measurements at ``times (time,)``, s.

    ``points (time, feature, 3)``, m, in inertially fixed axes; or attitudes ``q (time, 4)``, scalar
    first, from body to inertial axes; or ``rates (time, 3)``, rad/s, in axes fixed in the body. NaN
    is not observed. ``sigma`` is their noise in m, rad or rad/s: one number, or one for each of
    them; None: it is found from the data. ``model (feature, 3)``, m: places of the points in the
    body, if known. Raises UserError for arrays that do not fit. How it ended is ``status``.
    """
    given = {"points": points, "q": q, "rates": rates}
    arrays = {name: np.asarray(v, dtype=np.float64) for name, v in given.items() if v is not None}
    epochs = np.asarray(times, dtype=np.float64)
    noise = None if sigma is None else np.asarray(sigma, dtype=np.float64)
    body = None if model is None else np.asarray(model, dtype=np.float64)
    require_fitting(epochs, arrays, noise, body)
    if "points" in arrays:
        return estimate_from_points(epochs, arrays["points"], noise, body)
    if "q" in arrays:
        return estimate_from_attitudes(epochs, arrays["q"], noise)
    return estimate_from_rates(epochs, arrays["rates"], noise)


def schema(plugins: Iterable[str | Path] = ()) -> dict[str, Any]:
    """Return the JSON schema of scenario files."""
    load_plugins(read_plugins(map(Path, plugins)))
    return described(scenario_model(ScenarioFile).model_json_schema())


def _plain(value: Any) -> Any:
    """Return an array or a path as JSON knows it."""
    return value.tolist() if hasattr(value, "tolist") else str(value)
