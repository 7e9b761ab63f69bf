"""The cells of the tables along the curves of a scenario's cases."""

from collections import Counter
from collections.abc import Iterator

import pandas as pd

from debrisest.results.runs import SIMULATED
from debrisest.scenario.curves import FEWEST, curves
from debrisest.scenario.load import LoadedScenario
from debrisest.show.plots.error_over_value import COLUMNS, ONE_PANEL
from debrisest.show.plots.gather import Source


def along_curves(scenario: LoadedScenario, cells: pd.DataFrame) -> Iterator[Source]:
    """Yield the cells of each set of cases that are alike but for one number."""
    found = curves(scenario.cases)
    rows = cells[cells["estimator"] != SIMULATED]
    alike = Counter(curve.key for curve in found)
    for curve in found:
        told = rows.assign(key=curve.key, value=rows["case"].map(curve.values))
        told = told[told["value"].notna() & told["measured"].notna()]
        enough = told.groupby([*ONE_PANEL, "estimator"])["value"].transform("nunique") >= FEWEST
        told = told[enough].sort_values("value", kind="stable")
        if len(told):
            first = [next(iter(curve.values))] * (alike[curve.key] > 1)
            context = f"{scenario.name}, cases {', '.join(curve.values)}"
            data = {name: told[name].to_numpy() for name in COLUMNS}
            yield Source((curve.key.rpartition(".")[2], *first), context, data)
