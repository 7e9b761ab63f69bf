"""Which part of scenarios a command is asked for."""

from collections.abc import Container, Sequence
from dataclasses import dataclass

from debrisest.errors import UserError, allowed_names
from debrisest.results.address import Address
from debrisest.results.runs import SIMULATED
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.schema import MOST_RUNS


@dataclass(frozen=True)
class Selection:
    """Which part of a scenario is asked for; None is all."""

    runs: int | None = None
    cases: Sequence[str] | None = None
    estimators: Sequence[str] | None = None
    last_stage: str = "assess"
    force: bool = False
    again: Container[Address] = ()
    """Files that are computed anew although they may be up to date."""

    def asks_for(self, case: str, estimator: str, means: Container[str]) -> bool:
        """Return whether a cell belongs to it; means belong to a selection of all cases."""
        case_fits = self.cases is None or (case in self.cases and case not in means)
        if estimator == SIMULATED or self.estimators is None:
            return case_fits
        return case_fits and estimator in self.estimators


def check_selection(scenarios: Sequence[LoadedScenario], selection: Selection) -> None:
    """Raise UserError for a name that is asked for and that no scenario has."""
    cases = [name for scenario in scenarios for name in scenario.cases]
    estimators = [name for scenario in scenarios for name in scenario.common.estimators]
    asked = (("case", selection.cases, cases), ("estimator", selection.estimators, estimators))
    problems = [
        f"--{what} {name}: unknown {what}; {allowed_names(name, dict.fromkeys(known))}"
        for what, names, known in asked
        for name in names or []
        if name not in known
    ]
    if selection.runs is not None and not 1 <= selection.runs <= MOST_RUNS:
        problems.append(f"--runs {selection.runs}: from 1 to {MOST_RUNS} are possible")
    if problems:
        raise UserError(problems)
