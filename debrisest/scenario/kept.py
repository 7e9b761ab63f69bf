"""Whether covariances are kept where a scenario's tables need them."""

from collections.abc import Iterator, Mapping

from debrisest.assessment.statistics import window_mask
from debrisest.parts.filters.kalman import kept_epochs
from debrisest.roles import FilterPart
from debrisest.scenario.case import Case
from debrisest.scenario.document import KeyPath
from debrisest.scenario.table_keys import Table
from debrisest.scenario.window import window_of
from debrisest.vocabulary import WHERE_KEPT


def kept_too_late(case: Case) -> Iterator[tuple[KeyPath, str]]:
    """Yield the filters of a case that would keep a covariance after its end."""
    scenario = case.scenario
    for name, part in _filters(case):
        late = [time for time in part.kept_s or [] if time > scenario.duration_s]
        if late:
            told = ", ".join(f"{time:g}" for time in late)
            yield (
                ("estimators", name, "filter", "keep_s"),
                f"the scenario lasts {scenario.duration_s:g} s; "
                f"no covariance can be kept at {told} s",
            )


def not_kept(
    path: KeyPath, table: Table, cases: Mapping[str, Case]
) -> Iterator[tuple[KeyPath, str]]:
    """Yield the windows of a table in which no filter of any case keeps what it shows."""
    names = [name for name in table.quantities if name in WHERE_KEPT]
    used = [
        (case, part)
        for name, case in cases.items()
        if table.cases is None or name in _members(table.cases, case.scenario.tables.means)
        for _, part in _filters(case)
    ]
    if not names or not used:
        return
    for number, window in enumerate(table.windows):
        if not any(_keeps(part, case, window) for case, part in used):
            yield (
                (*path, number),
                f"no estimator keeps its covariance at {window}, which {names[0]} needs; "
                "add a time to keep_s of a filter",
            )


def _keeps(part: FilterPart, case: Case, window: str) -> bool:
    if part.kept_s is None:
        return True
    clock = case.clock
    inside = window_mask(clock.times, window_of(window, case.scenario.duration_s))
    return bool(inside[[*kept_epochs(part.kept_s, clock), -1]].any())


def _members(shown: list[str], means: Mapping[str, list[str]]) -> set[str]:
    """Return the cases that a table shows, by themselves or in a mean."""
    return {case for name in shown for case in means.get(name, [name])}


def _filters(case: Case) -> Iterator[tuple[str, FilterPart]]:
    """Yield the filters that are used in a case, by the names of their estimators."""
    for name in case.estimators:
        if (part := case.scenario.estimators[name].filter) is not None:
            yield name, part
