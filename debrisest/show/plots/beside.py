"""What the tables have beside the errors of a case: units, bound, published values."""

from collections.abc import Iterable

from debrisest.results.assessed import Assessed
from debrisest.scenario.load import LoadedScenario
from debrisest.show.plots.gather import Beside
from debrisest.show.plots.histograms import window
from debrisest.show.tables.published import published_values


def beside(
    scenario: LoadedScenario, results: Assessed, case: str, estimator: str, names: Iterable[str]
) -> Beside:
    """Return what stands beside a figure of the runs' mean errors over the settled time."""
    units: dict[str, str] = {}
    for table in scenario.common.tables.layout:
        units |= table.units
    bound = results.get((case, scenario.common.estimators[estimator].bound))
    there = {} if bound is None else bound.errors
    errors = {name: there[name][bound.good] for name in names if bound and name in there}
    settled = window(results[case, estimator].times)
    published = {
        key.quantity: entry.value
        for key, entry in published_values(scenario).items()
        if (key.case, key.statistic, key.window) == (case, "p50", settled)
        and entry.value is not None
    }
    return Beside(units, errors, published)
