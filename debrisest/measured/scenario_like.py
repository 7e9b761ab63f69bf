"""A scenario of measured data with the estimators, the tables and the target of another one."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.errors import UserError
from debrisest.measured.default_scenario import Text
from debrisest.parts.truth.rigid_points import RigidPoints
from debrisest.scenario.case import Case
from debrisest.scenario.checks import case_problems, file_problems
from debrisest.scenario.document import Document
from debrisest.scenario.load import NOMINAL, LoadedScenario
from debrisest.scenario.measured import told_by_data
from debrisest.scenario.mistakes import validated
from debrisest.scenario.models import scenario_model
from debrisest.tracks.types import BodyPoints


def scenario_like(
    scenario: LoadedScenario, measured: Mapping[str, Any], folder: Path, data: Data
) -> tuple[Text, list[str]]:
    """Return a scenario of measured data with the estimators and tables of another one.

    ``measured`` is the part that gives ``data``, as in YAML; its paths count from ``folder``. What
    the data cannot serve is left out, and told in sentences. Raises `UserError` where no estimator
    is left.
    """
    common = scenario.common
    written = common.model_dump(
        mode="json", exclude_unset=True, include={"starts", "estimators", "tables"}
    )
    text: Text = {"title": common.title, "measured": dict(measured), "estimators": {}}
    reasons: dict[str, list[str]] = {}
    for name, start in written.get("starts", {}).items():
        starts = text.get("starts", {}) | {name: start}
        if not _problems(text | {"starts": starts}, folder, scenario):
            text["starts"] = starts
    for name, estimator in written["estimators"].items():
        one = _of_any_case(estimator, Clock(data["time_s"]))
        if wrong := _problems(text | {"estimators": {name: one}}, folder, scenario):
            reasons.setdefault("; ".join(wrong), []).append(name)
        else:
            text["estimators"][name] = one
    told = [f"left out: {', '.join(names)}: {why}" for why, names in reasons.items()]
    if not text["estimators"]:
        raise UserError([*told, f"no estimator of {scenario.path} is left for these data"])
    text["tables"], left_out = _tables(text, written.get("tables", {}), folder, scenario)
    return text, told + left_out


def known_geometry(scenario: LoadedScenario) -> BodyPoints | None:
    """Return the target's points in the frame ``f``, as a simulation tells them, if it has any."""
    target = scenario.common.target
    if not isinstance(target, RigidPoints):
        return None
    data = target.simulate({}, Clock(np.arange(2.0)), Draws(0, NOMINAL, [0]))
    names, points = tuple(data["feature"].tolist()), data["known_point_f"][0]
    note = f"geometry of {scenario.path}: body axes are those of its first three points"
    return BodyPoints(str(scenario.path), names, points, (note,))


def _of_any_case(estimator: Text, clock: Clock) -> Text:
    """Return an estimator without what is about cases, bounds, or times after the data's end."""
    one = {key: value for key, value in estimator.items() if key not in ("cases", "bound")}
    if (kept := one.get("filter", {}).get("keep_s")) is not None:
        one["filter"] = one["filter"] | {"keep_s": [t for t in kept if clock.reaches(t)]}
    return one


def _tables(
    text: Text, tables: Text, folder: Path, scenario: LoadedScenario
) -> tuple[Text, list[str]]:
    """Return those of the tables that the data allow, and a sentence on the others."""
    kept: Text = {}
    if "scored_window" in tables:
        window = {"scored_window": tables["scored_window"]}
        kept |= {} if _problems(text | {"tables": window}, folder, scenario) else window
    left_out = 0
    for key in ("diverged", "layout"):
        for entry in tables.get(key, []):
            one = {name: value for name, value in entry.items() if name != "cases"}
            if _problems(text | {"tables": {key: [one]}}, folder, scenario):
                left_out += 1
            else:
                kept.setdefault(key, []).append(one)
    told = f"{left_out} tables or rules are left out: their windows are not in the data"
    return kept, [told] if left_out else []


def _problems(text: Text, folder: Path, scenario: LoadedScenario) -> list[str]:
    """Return what is wrong with a scenario of measured data, in sentences."""
    complete, wrong = told_by_data(Document(text), folder)
    found, more = validated(complete, scenario_model(), folder)
    if found is None or wrong:
        return [problem.message for problem in wrong + more]
    plugins = next(iter(scenario.cases.values())).plugins
    case = Case(scenario.name, NOMINAL, complete.value, folder.absolute(), plugins)
    unfit = (*case_problems(case), *file_problems({NOMINAL: case}))
    return [message for _, message in unfit]
