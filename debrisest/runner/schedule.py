"""Which step comes next: in their order, each after those that it reads."""

from collections.abc import Iterable
from heapq import heappop, heappush

from debrisest.runner.plan import Step


class Schedule:
    """Steps that are due; one is ready when all that are due before it are done."""

    def __init__(self, steps: Iterable[Step]) -> None:
        self._steps = list(steps)
        number = {step.path: index for index, step in enumerate(self._steps)}
        before = [
            [number[up.path] for up in step.upstream if up.path in number] for step in self._steps
        ]
        self._missing = [len(needed) for needed in before]
        self._after: list[list[int]] = [[] for _ in self._steps]
        for index, needed in enumerate(before):
            for one in needed:
                self._after[one].append(index)
        self._ready = [index for index, missing in enumerate(self._missing) if not missing]
        self._number = number

    def take(self, most: int) -> list[Step]:
        """Return the next steps that are ready, no more than so many."""
        count = max(min(most, len(self._ready)), 0)
        return [self._steps[heappop(self._ready)] for _ in range(count)]

    def done(self, step: Step) -> None:
        """Note that a step wrote its file; one that did not keeps what needs it from running."""
        for index in self._after[self._number[step.path]]:
            self._missing[index] -= 1
            if not self._missing[index]:
                heappush(self._ready, index)

    def stop(self) -> None:
        """Let no further step be ready."""
        self._ready, self._after = [], [[] for _ in self._steps]
