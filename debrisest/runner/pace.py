"""How long what is still to do will take: from files of before, and from those just written."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from typing import Any

from debrisest.results import store
from debrisest.results.address import Address
from debrisest.results.chunk import Chunk
from debrisest.runner.step import Step


class Pace:
    """The CPU time per run of like steps: of the same estimator and case, or else of any case."""

    def __init__(self, due: Sequence[Step], known: Iterable[Chunk] = ()) -> None:
        self._left = Counter[tuple[str, ...]]()
        for step in due:
            self._left[_like(step.address)] += step.runs
        self._seconds: dict[tuple[str, ...], list[float]] = defaultdict(list)
        self._spent = 0.0
        for chunk in known:
            self._learn(chunk.address, chunk.attributes)

    def done(self, step: Step) -> None:
        """Note that a step has ended, and how long it took, which its file tells."""
        self._left[_like(step.address)] -= step.runs
        found = store.inspect(step.path, store.Depth.LABEL)
        if found.condition is store.Condition.WHOLE:
            self._learn(step.address, found.attributes)
            self._spent += float(found.attributes.get("cpu_s", 0.0))

    def left(self, elapsed: float) -> float | None:
        """Return the seconds that are left after ``elapsed`` ones, if all steps have like ones."""
        each = [(runs, self._expected(like)) for like, runs in self._left.items() if runs]
        if not self._spent or any(seconds is None for _, seconds in each):
            return None
        return elapsed * sum(runs * (seconds or 0.0) for runs, seconds in each) / self._spent

    def _learn(self, address: Address, told: dict[str, Any]) -> None:
        if "cpu_s" in told and told.get("runs"):
            like, seconds = _like(address), float(told["cpu_s"]) / int(told["runs"])
            self._seconds[like].append(seconds)
            self._seconds[like[1:]].append(seconds)

    def _expected(self, like: tuple[str, ...]) -> float | None:
        found = self._seconds.get(like) or self._seconds.get(like[1:])
        return sum(found) / len(found) if found else None


def _like(address: Address) -> tuple[str, ...]:
    return (address.case, address.scenario, address.stage, address.estimator)
