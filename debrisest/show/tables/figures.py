"""The figures per run that a cell of the tables is made of."""

from collections.abc import Iterable, Iterator
from itertools import product, starmap

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.results.figured import Figure
from debrisest.results.runs import SIMULATED, Runs
from debrisest.scenario.table_keys import Table, Tables
from debrisest.show.tables.published import CellKey
from debrisest.vocabulary import VOCABULARY, table_scale

DOUBT = Figure("doubt", "mean", "end")
"""Whether a run of a bound says that it is none."""


def keys_of(
    table: Table, tables: Tables, cases: Iterable[str], estimators: Iterable[str]
) -> Iterator[tuple[CellKey, str]]:
    """Yield the cells of a table with their estimators, in the order of the table."""
    names = table.cases or [*cases, *tables.means]
    columns = product(table.statistics, table.windows)
    cells = product(
        names, [SIMULATED] if table.stage == "simulate" else estimators, table.quantities
    )
    for (statistic, window), (case, estimator, quantity) in product(columns, cells):
        yield CellKey(table.table, case, quantity, statistic, window), estimator


def dataset_of(table: Table, quantity: str) -> str:
    """Return where a quantity lies: what a recovery gives is told apart by its name."""
    recovered = f"recovered_{quantity}"
    return recovered if table.stage == "recover" and recovered in VOCABULARY else quantity


def unit_of(table: Table, quantity: str) -> str:
    """Return the unit in which a table shows a quantity."""
    return table.units.get(quantity) or VOCABULARY[dataset_of(table, quantity)].table_unit


def figures_of(tables: Tables, case: str) -> set[Figure]:
    """Return all figures that the tables, and their rules of divergence, need of a case."""
    found: set[Figure] = set()
    for table in tables.layout:
        names = table.cases or [case]
        if case in (one for name in names for one in tables.means.get(name, [name])):
            datasets = [dataset_of(table, name) for name in table.quantities]
            found |= set(starmap(Figure, product(datasets, table.statistics, table.windows)))
    if found:
        found |= {Figure(rule.quantity, rule.statistic, rule.window) for rule in tables.diverged}
    return found | {DOUBT} if any(one.dataset == DOUBT.dataset for one in found) else found


def figures(
    part: Runs, key: CellKey, table: Table, tables: Tables
) -> tuple[Array, BoolArray, BoolArray]:
    """Return figures per run (run,), which of them count, and which runs diverged.

    The rules of divergence speak of a filter's result; a recovery counts unless it is not finite.
    """
    dataset = dataset_of(table, key.quantity)
    values = part.figures(dataset, key.statistic, key.window)
    values = values * (table_scale(dataset, unit_of(table, key.quantity)) / table_scale(dataset))
    lost = part.good & ~np.isfinite(values)
    if table.stage == "filter" and not table.count_diverged:
        lost |= part.diverged(tables.diverged)
    return values, part.good & ~lost, lost
