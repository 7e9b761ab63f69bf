"""Which step comes next: in their order, each after those that it reads."""

from collections.abc import Hashable, Iterable
from heapq import heappop, heappush

from debrisest.runner.step import Step


class Schedule:
    """Steps that are due; one is ready when all that are due before it are done."""

    def __init__(self, steps: Iterable[Step], width: int = 1) -> None:
        self._steps, self._width = list(steps), width
        number = {step.path: index for index, step in enumerate(self._steps)}
        before = [
            [number[up.path] for up in step.upstream if up.path in number] for step in self._steps
        ]
        self._missing = [len(needed) for needed in before]
        self._after: list[list[int]] = [[] for _ in self._steps]
        for index, needed in enumerate(before):
            for one in needed:
                self._after[one].append(index)
        self._alike: dict[Hashable, list[int]] = {}
        self._ready: list[int] = []
        self._taken: set[int] = set()
        self._number = number
        for index, missing in enumerate(self._missing):
            if not missing:
                self._add(index)

    def take(self) -> list[Step]:
        """Return the next step that is ready, with others like it; nothing where none is ready.

        Never more than would leave less for the other workers than for this one.
        """
        while self._ready and self._ready[0] in self._taken:
            self._taken.remove(heappop(self._ready))
        if not self._ready:
            return []
        first = self._steps[self._ready[0]]
        alike = self._alike[first.kin]
        share = -(-(len(self._ready) - len(self._taken)) // self._width)
        chosen, runs = [heappop(alike)], first.runs
        while alike and len(chosen) < share:
            if (runs := runs + self._steps[alike[0]].runs) > first.together:
                break
            chosen.append(heappop(alike))
        self._taken.update(chosen)
        return [self._steps[index] for index in chosen]

    def _add(self, index: int) -> None:
        heappush(self._ready, index)
        heappush(self._alike.setdefault(self._steps[index].kin, []), index)

    def done(self, step: Step) -> None:
        """Note that a step wrote its file; one that did not keeps what needs it from running."""
        for index in self._after[self._number[step.path]]:
            self._missing[index] -= 1
            if not self._missing[index]:
                self._add(index)

    def stop(self) -> None:
        """Let no further step be ready."""
        self._ready, self._taken, self._after = [], set(), [[] for _ in self._steps]
