"""What there is of a scenario's results, what is out of date and why, and how runs ended."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from debrisest.results.results import Results
from debrisest.results.status import Wanted


class Row(NamedTuple):
    """The state of an estimator in a case; no estimator stands for the simulation."""

    scenario: str
    case: str
    estimator: str
    there: int
    """Runs that its last file holds, up to date or not."""
    wanted: int
    due: tuple[str, ...]
    """Why files are out of date, a sentence for each; empty where all are up to date."""
    failed: Counter[str]
    """How many runs gave no result, by the stage and the reason."""
    ended: Counter[str]
    """How many runs ended in which way, by the stage and what it says."""

    def lines(self) -> Iterator[str]:
        """Yield the row in words."""
        of, state = self.estimator or "simulation", "out of date" if self.due else "up to date"
        there = f"{self.there} runs there, {self.wanted} wanted"
        yield f"{self.scenario} {self.case}, {of}: {there}, {state}"
        if self.due:
            yield f"  {self.due[0]}" + f" (and {len(self.due) - 1} more)" * (len(self.due) > 1)
        for how, runs in (self.failed + self.ended).most_common():
            yield f"  {how} ({runs} runs)"


def overview(results: Results, wanted: Iterable[Wanted]) -> list[Row]:
    """Return a row for the simulation and each estimator of each case that a plan wants."""
    groups: dict[tuple[str, str], list[Wanted]] = {}
    for one in wanted:
        groups.setdefault((one.address.case, one.address.estimator), []).append(one)
    return [_row(results, files) for files in groups.values()]


def _row(results: Results, wanted: Sequence[Wanted]) -> Row:
    scenario, case, last, estimator, _ = wanted[-1].address
    failures = results.failures(case, estimator)
    return Row(
        scenario=scenario,
        case=case,
        estimator=estimator,
        there=results.runs(case, estimator, last),
        wanted=sum(one.runs for one in wanted if one.address.stage == last),
        due=tuple(f"{one.name}: {one.reason}" for one in wanted if one.reason),
        failed=Counter(f"{failure.address.stage} failed: {failure.why}" for failure in failures),
        ended=Counter(_endings(results, case, estimator)),
    )


def _endings(results: Results, case: str, estimator: str) -> Iterator[str]:
    """Yield how each stage of each run ended, where it says so."""
    for stage in results.stages(case, estimator):
        if "status" in results.datasets(case, estimator, stage):
            told = results.load(case, estimator, stage, names=("run", "status"))
            yield from (f"{stage}: {status}" for status in told.get("status", ()) if status)
