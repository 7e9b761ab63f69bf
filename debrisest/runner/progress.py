"""Progress on standard error: a bar with the time left on a terminal, plain lines elsewhere."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from debrisest.counted import Part


class Progress(Protocol):
    """What is told while steps are run."""

    def part(self, part: Part) -> None:
        """Tell how far a step is."""

    def done(self, name: str) -> None:
        """Tell that a step is finished."""

    def say(self, text: str) -> None:
        """Tell something that should stay on the screen."""


@contextmanager
def progress(steps: int, quiet: bool = False) -> Iterator[Progress]:
    """Yield the teller that suits standard error."""
    if quiet:
        yield _Silent()
    elif sys.stderr.isatty():
        with _bar(steps) as bar:
            yield bar
    else:
        yield _Lines(steps)


class _Silent:
    def part(self, part: Part) -> None:
        """Leave out how far a step is."""

    def done(self, name: str) -> None:
        """Count a step that has ended."""

    def say(self, text: str) -> None:
        """Print a line beside the progress."""
        print(text, file=sys.stderr, flush=True)


class _Lines:
    def __init__(self, steps: int) -> None:
        self._steps, self._finished = steps, 0
        self._told: dict[str, tuple[str, int]] = {}

    def part(self, part: Part) -> None:
        """Print a line for each tenth of a step's parts."""
        tenth = part.what, 10 * part.done // part.total
        if self._told.get(part.step) != tenth:
            self._told[part.step] = tenth
            self.say(f"  {part.step}: {part.what} {part.done} of {part.total}")

    def done(self, name: str) -> None:
        """Count a step that has ended."""
        self._finished += 1
        self.say(f"[{self._finished}/{self._steps}] {name}")

    def say(self, text: str) -> None:
        """Print a line beside the progress."""
        print(text, file=sys.stderr, flush=True)


@contextmanager
def _bar(steps: int) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bars

    last = TextColumn("{task.fields[last]}", markup=False)
    columns = BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), last
    with Bars(*columns, console=Console(stderr=True)) as bars:
        task = bars.add_task("steps", total=steps, last="")
        running: dict[str, tuple[str, TaskID]] = {}

        class Bar:
            def part(self, part: Part) -> None:
                """Show a bar for a step's parts of one kind."""
                if running.get(part.step, ("",))[0] != part.what:
                    self._end(part.step)
                    bar = bars.add_task("parts", last=f"{part.step}: {part.what}")
                    running[part.step] = part.what, bar
                bars.update(running[part.step][1], completed=part.done, total=part.total)

            def done(self, name: str) -> None:
                """Count a step that has ended."""
                self._end(name)
                bars.update(task, advance=1, last=name)

            def _end(self, name: str) -> None:
                if name in running:
                    bars.remove_task(running.pop(name)[1])

            def say(self, text: str) -> None:
                """Print a line beside the progress."""
                bars.console.print(text, highlight=False, markup=False)

        yield Bar()
