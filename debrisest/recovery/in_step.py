"""Searches that recover signals again and again, in step, so that their signals share a batch."""

from collections.abc import Callable, Generator, Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, ComplexArray
from debrisest.recovery.basis_pursuit import Recovered


class Question(NamedTuple):
    """Signals of one search that are to be recovered, by so many atoms and iterations."""

    samples: Array
    """(row, time)."""
    observed: BoolArray
    """(time,)."""
    length: int
    iterations: int
    start: ComplexArray | None
    """Coefficients (row, length // 2 + 1) to start from."""

    @property
    def kind(self) -> tuple[int, int, bool]:
        """Return what questions that go together have in common."""
        return self.length, self.iterations, self.start is None


Search = Generator[Question, Recovered, Array]
"""Asks for recoveries, and returns what it found."""

Recovery = Callable[[Question], Recovered]
"""Recovers signals; `observed` (row, time) is that of each where searches are put together."""


def in_step(searches: Sequence[Search], recover: Recovery) -> list[Array]:
    """Return what each search finds; questions with as many atoms and iterations go together."""
    found: dict[int, Array] = {}
    asked = {index: next(search) for index, search in enumerate(searches)}
    while asked:
        answers: dict[int, Recovered] = {}
        for kind in {question.kind for question in asked.values()}:
            alike = [index for index, question in asked.items() if question.kind == kind]
            answers |= zip(alike, _together([asked[index] for index in alike], recover))
        asked = {}
        for index, answer in answers.items():
            try:
                asked[index] = searches[index].send(answer)
            except StopIteration as end:
                found[index] = end.value
    return [found[index] for index in range(len(searches))]


def _together(questions: list[Question], recover: Recovery) -> list[Recovered]:
    """Recover the signals of several questions at once; none is observed beyond its window."""
    if len(questions) == 1:
        return [recover(questions[0])]
    ends = np.cumsum([len(question.samples) for question in questions])
    samples = np.zeros((ends[-1], max(question.samples.shape[1] for question in questions)))
    observed = np.zeros(samples.shape, bool)
    rows = [slice(end - len(each.samples), end) for end, each in zip(ends, questions)]
    for row, (signals, seen, *_) in zip(rows, questions):
        samples[row, : len(seen)], observed[row, : len(seen)] = signals, seen
    starts = [question.start for question in questions if question.start is not None]
    start = np.concatenate(starts) if starts else None
    every = recover(questions[0]._replace(samples=samples, observed=observed, start=start))
    return [
        Recovered(
            signal=every.signal[row, : len(question.observed)],
            coefficients=every.coefficients[row],
            length=every.length,
            objective=every.objective[row],
            iterations=every.iterations[row],
            status=every.status[row],
        )
        for row, question in zip(rows, questions)
    ]
