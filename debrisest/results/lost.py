"""The files whose runs gave no result, or one that counts as diverged."""

from collections.abc import Iterable, Iterator

import numpy as np

from debrisest.results.address import Address
from debrisest.results.figured import Figure, figured
from debrisest.results.results import Results
from debrisest.scenario.table_keys import Divergence


def lost(results: Results, rules: Iterable[Divergence]) -> set[Address]:
    """Return where a run failed first, and the estimates of runs that broke one of the rules."""
    return {*(failure.address for failure in results.failures()), *_diverged(results, list(rules))}


def _diverged(results: Results, rules: list[Divergence]) -> Iterator[Address]:
    figures = {Figure(rule.quantity, rule.statistic, rule.window) for rule in rules}
    found = figured(results, lambda _: figures)
    for (case, estimator), result in found.items():
        runs = np.flatnonzero(result.diverged(rules))
        stage = results.stages(case, estimator)[-2:][0]
        for chunk in results.chunks:
            of = chunk.address
            own = (of.case, of.estimator, of.stage) == (case, estimator, stage)
            if own and ((runs >= of.first_run) & (runs < of.first_run + chunk.runs)).any():
                yield of
