"""What must fit together across the keys of a scenario, each problem with its key path."""

from collections.abc import Mapping

import numpy as np

from debrisest import arithmetic
from debrisest.arrays import Data
from debrisest.assessment.statistics import window_mask
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.errors import NO_MEMORY, allowed_names
from debrisest.scenario.case import Case
from debrisest.scenario.contracts import Found, parts_that_do_not_fit
from debrisest.scenario.document import KeyPath
from debrisest.scenario.kept import kept_too_late, not_kept
from debrisest.scenario.names import same_draws, same_on_disk
from debrisest.scenario.schema import Scenario
from debrisest.scenario.table_keys import Table
from debrisest.scenario.window import window_of
from debrisest.vocabulary import VOCABULARY

MOST_EPOCHS = 10_000_000


def case_problems(case: Case) -> Found:
    """Yield what does not fit together within one case."""
    found = [] if case.source else list(_wrong_epochs(case.scenario))
    yield from found
    if not found:
        yield from parts_that_do_not_fit(case)
        yield from _windows(case)
        yield from kept_too_late(case)


def _wrong_epochs(scenario: Scenario) -> Found:
    if scenario.step_s is None:
        yield ("step_s",), "this key is missing"
        return
    epochs = scenario.duration_s / scenario.step_s
    if not 2 <= epochs <= MOST_EPOCHS:
        yield ("step_s",), f"gives {epochs:.3g} epochs; from 2 to {MOST_EPOCHS} are possible"
    elif abs(epochs - round(epochs)) > 1e-9 * epochs:
        yield ("duration_s",), f"must be a whole number of steps of {scenario.step_s:g} s"
    if not scenario.sensors:
        yield ("sensors",), "this key is missing: nothing would be measured"


def file_problems(cases: Mapping[str, Case]) -> Found:
    """Yield what does not fit together between the cases of a file."""
    first = next(iter(cases.values())).scenario
    for name, case in cases.items():
        scenario = case.scenario
        if list(scenario.estimators) != list(first.estimators):
            yield ("cases", name), "all cases of a scenario must have the same estimators"
        if scenario.tables != first.tables:
            yield ("cases", name, "tables"), "tables belong to the whole file, not to a case"
    for name, why in same_on_disk(first.estimators):
        yield ("estimators", name), why
    bound = {case.draws: name for name, case in reversed([*cases.items()])}
    for draws, why in same_draws(dict.fromkeys(case.draws for case in cases.values())):
        yield ("cases", bound[draws], "draws"), why
    yield from _unknown_cases(first, list(cases))
    refused = (found for case in cases.values() for found in _parts_that_refuse(case))
    yield from dict.fromkeys(refused)
    for index, table in enumerate(first.tables.layout):
        yield from table_problems(("tables", "layout", index), table, cases)


def table_problems(path: KeyPath, table: Table, cases: Mapping[str, Case]) -> Found:
    """Yield what a table shows and no case has."""
    if table.stage == "simulate":
        yield from _not_simulated((*path, "quantities"), table, cases)
    elif table.stage == "filter":
        yield from not_kept((*path, "windows"), table, cases)


def _parts_that_refuse(case: Case) -> Found:
    """Simulate one run of the first epochs, where a part wants it."""
    parts = case.scenario.simulation
    if not any(part.tried for part in parts.values()):
        return
    clock, draws = Clock(case.clock.times[:2]), Draws(case.scenario.seed, "", [0])
    measured = case.measured_runs(np.array([0])) if case.source else {}
    data: Data = {**measured, "time_s": clock.times}
    for path, part in parts.items():
        try:
            with arithmetic.strict():
                data |= part.simulate_named(path.partition(".")[2], data, clock, draws)
        except arithmetic.FAILURES as error:
            yield tuple(path.split(".", 1)), arithmetic.told(error)
            return
        except ValueError as error:
            yield tuple(path.split(".", 1)), str(error)
            return
        except MemoryError:
            yield tuple(path.split(".", 1)), NO_MEMORY
            return


def _windows(case: Case) -> Found:
    tables, duration = case.scenario.tables, case.scenario.duration_s
    named: list[tuple[KeyPath, str]] = [
        (("tables", "layout", index, "windows", number), window)
        for index, table in enumerate(tables.layout)
        for number, window in enumerate(table.windows)
    ]
    named += [
        (("tables", "diverged", index, "window"), rule.window)
        for index, rule in enumerate(tables.diverged)
    ]
    if tables.scored_window is not None:
        named.append((("tables", "scored_window"), tables.scored_window))
        if len(set(window_of(tables.scored_window, duration))) == 1:
            yield ("tables", "scored_window"), "a span such as 900-1400 s is needed here"
    for path, window in named:
        if window_of(window, duration)[1] > duration:
            yield path, f"{window} goes beyond the scenario, which lasts {duration:g} s"
        elif not window_mask(case.clock.times, window_of(window, duration)).any():
            yield path, f"{window} holds no epoch"


def _not_simulated(path: KeyPath, table: Table, cases: Mapping[str, Case]) -> Found:
    parts = [part for case in cases.values() for part in case.scenario.simulation.values()]
    given = {name for part in parts for name in part.given}
    shown = {name for name in given if VOCABULARY[name].table_unit}
    for name in table.quantities:
        if name not in shown:
            allowed = allowed_names(name, sorted(shown)) if shown else "nothing that a table shows"
            yield path, f"no part of the simulation gives {name!r}; {allowed}"
        elif VOCABULARY[name].axes not in (("run",), ("run", "time_s")):
            yield path, f"{name} has components; a table shows a figure per run, or per epoch"


def _unknown_cases(scenario: Scenario, cases: list[str]) -> Found:
    tables = scenario.tables
    for name, estimator in scenario.estimators.items():
        if "bound" in estimator.model_fields_set and estimator.bound not in scenario.estimators:
            known = allowed_names(estimator.bound, scenario.estimators)
            yield ("estimators", name, "bound"), f"no estimator {estimator.bound!r}; {known}"
        for case in estimator.cases or []:
            if case not in cases:
                yield ("estimators", name, "cases"), _unknown(case, cases)
    for mean, members in tables.means.items():
        if mean in cases:
            yield ("tables", "means", mean), "a case has this name already; choose another"
        for case in members:
            if case not in cases:
                yield ("tables", "means", mean), _unknown(case, cases)
    for index, table in enumerate(tables.layout):
        for case in table.cases or []:
            if case not in cases and case not in tables.means:
                path = ("tables", "layout", index, "cases")
                yield path, _unknown(case, [*cases, *tables.means])


def _unknown(case: str, known: list[str]) -> str:
    return f"unknown case {case!r}; {allowed_names(case, known)}"
