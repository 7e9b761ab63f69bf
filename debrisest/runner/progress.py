"""Progress on standard error: on a terminal what runs and the time left, plain lines elsewhere."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import timedelta
from time import monotonic
from typing import TYPE_CHECKING, Protocol

from debrisest.counted import Part
from debrisest.runner.step import Step

if TYPE_CHECKING:
    from rich.progress import Progress as Bars
    from rich.progress import TaskID

Left = Callable[[float], float | None]
"""From the seconds that have passed to those that are left, if that is known."""
_PAUSE_S = 1.0
"""Between two looks at what is left."""


class Progress(Protocol):
    """What is told while steps are run."""

    def started(self, steps: Sequence[Step]) -> None:
        """Tell that steps begin."""

    def part(self, part: Part) -> None:
        """Tell how far a step is."""

    def done(self, name: str) -> None:
        """Tell that a step is finished."""

    def say(self, text: str) -> None:
        """Tell something that should stay on the screen."""


@contextmanager
def progress(steps: int, quiet: bool = False, left: Left | None = None) -> Iterator[Progress]:
    """Yield the teller that suits standard error.

    Steps are taken to last alike where nobody says what is left.
    """
    if quiet:
        yield _Silent()
    elif sys.stderr.isatty():
        with _bar(steps, left) as bar:
            yield bar
    else:
        yield _Lines(steps)


class _Silent:
    def started(self, steps: Sequence[Step]) -> None:
        """Leave out that steps begin."""

    def part(self, part: Part) -> None:
        """Leave out how far a step is."""

    def done(self, name: str) -> None:
        """Count a step that has ended."""

    def say(self, text: str) -> None:
        """Print a line beside the progress."""
        print(text, file=sys.stderr, flush=True)


class _Lines(_Silent):
    def __init__(self, steps: int) -> None:
        self._steps, self._finished = steps, 0
        self._told: dict[str, tuple[str, int]] = {}

    def part(self, part: Part) -> None:
        """Print a line for each tenth of a step's parts."""
        tenth = part.what, 10 * part.done // part.total
        if self._told.get(part.step) != tenth:
            self._told[part.step] = tenth
            self.say(f"  {part} {part.done} of {part.total}")

    def done(self, name: str) -> None:
        """Count a step that has ended."""
        self._finished += 1
        self.say(f"[{self._finished}/{self._steps}] {name}")


@contextmanager
def _bar(steps: int, left: Left | None) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bars

    texts = (TextColumn(f"{{task.fields[{name}]}}", markup=False) for name in ("left", "now"))
    columns = BarColumn(20), MofNCompleteColumn(), TimeElapsedColumn(), *texts
    with Bars(*columns, console=Console(stderr=True)) as bars:
        yield _Bar(bars, steps, left)


class _Bar:
    def __init__(self, bars: "Bars", steps: int, left: Left | None) -> None:
        self._bars, self._steps, self._left = bars, steps, left
        self._task = bars.add_task("steps", total=steps, left="", now="")
        self._running: dict[str, None] = {}
        self._parts: dict[str, tuple[str, TaskID]] = {}
        self._began, self._looked, self._finished = monotonic(), 0.0, 0

    def started(self, steps: Sequence[Step]) -> None:
        """Tell that steps begin."""
        self._running.update(dict.fromkeys(step.name for step in steps))
        self._show()

    def part(self, part: Part) -> None:
        """Show a bar for a step's parts of one kind."""
        if self._parts.get(part.step, ("",))[0] != part.what:
            self._end(part.step)
            bar = self._bars.add_task("parts", left="", now=str(part))
            self._parts[part.step] = part.what, bar
        self._bars.update(self._parts[part.step][1], completed=part.done, total=part.total)

    def done(self, name: str) -> None:
        """Count a step that has ended."""
        self._finished += 1
        self._running.pop(name, None)
        self._end(name)
        self._show()

    def say(self, text: str) -> None:
        """Print a line beside the progress."""
        self._bars.console.print(text, highlight=False, markup=False)

    def _end(self, name: str) -> None:
        if name in self._parts:
            self._bars.remove_task(self._parts.pop(name)[1])

    def _show(self) -> None:
        first, more = next(iter(self._running), ""), len(self._running) - 1
        now = first + (f" (and {more} more)" if more > 0 else "")
        self._bars.update(self._task, completed=self._finished, now=now)
        if monotonic() - self._looked > _PAUSE_S:
            self._looked = monotonic()
            left = (self._left or self._alike)(self._looked - self._began)
            words = "" if left is None else f"{timedelta(seconds=round(left))} left"
            self._bars.update(self._task, left=words)

    def _alike(self, elapsed: float) -> float | None:
        left = self._steps - self._finished
        return elapsed * left / self._finished if self._finished else None
