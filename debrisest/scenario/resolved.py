"""The scenario of a single case, complete in itself: what a file of results stores of it.

Read again, it is the same case: the same name, the same draws, the same numbers to the bit, and
every default written out. Of the tables it has those that need no other case.
"""

from collections.abc import Collection
from typing import Any

from debrisest.scenario.case import Case
from debrisest.scenario.checks import table_problems
from debrisest.scenario.document import merge_values, text_of
from debrisest.scenario.schema import SIMULATED
from debrisest.scenario.table_keys import Table


def resolved(case: Case) -> str:
    """Return a scenario file (YAML) whose only case is this one, as ``settings`` has it."""
    return text_of(settings(case))


def settings(case: Case) -> dict[str, Any]:
    """Return the plain data of a scenario file whose only case is this one.

    Files of measured data are named by their whole paths; published values are left out.
    """
    every = case.scenario.model_dump(mode="json", exclude_none=True)
    value: dict[str, Any] = merge_values(every, case.document)
    if case.source:
        measured = case.source.keys_with(lambda name: str(case.folder / name))
        value = {k: v for k, v in value.items() if k not in SIMULATED} | {"measured": measured}
    if case.draws != case.name:
        value["draws"] = case.draws
    value["estimators"] = {name: _estimator(case, value, name) for name in case.estimators}
    value["tables"] = _tables(case, value["tables"])
    return value | {"cases": {case.name: {}}}


def _estimator(case: Case, value: dict[str, Any], name: str) -> dict[str, Any]:
    """Return an estimator without what it says of other cases and estimators."""
    told = {key: v for key, v in value["estimators"][name].items() if key != "cases"}
    if told["bound"] not in case.estimators:
        del told["bound"]
    return told


def _tables(case: Case, tables: dict[str, Any]) -> dict[str, Any]:
    means = {name: [case.name] for name, of in tables["means"].items() if case.name in of}
    layout = [
        table if shown is None else table | {"cases": shown}
        for table, model in zip(tables["layout"], case.scenario.tables.layout)
        if (shown := _shown(model, {case.name, *means})) != []
        and not any(table_problems((), model, {case.name: case}))
    ]
    left = {key: value for key, value in tables.items() if key != "published"}
    return left | {"means": means, "layout": layout}


def _shown(table: Table, there: Collection[str]) -> list[str] | None:
    """Return the cases and means that a table shows of those that are there; None: all."""
    return None if table.cases is None else [name for name in table.cases if name in there]
