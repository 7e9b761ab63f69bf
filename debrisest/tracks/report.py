"""What is wrong with one file: every problem at its line, told at once."""

from collections.abc import Callable

import numpy as np

from debrisest.arrays import BoolArray, IntArray
from debrisest.errors import UserError

MOST = 20
"""Problems of a file that are told in full; further ones are counted."""


class Refusal(str):
    """A sentence on data of which nothing can be estimated, among others that are only told."""


class Report:
    """Collects the problems of a file, each ``file:line: column: sentence``."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.problems: list[str] = []
        self.count = 0

    def add(self, line: int, message: str, column: str = "") -> None:
        """Add a problem of a line; line 0 is the file as a whole."""
        self.count += 1
        if self.count <= MOST:
            place = f"{self.source}:{line}" if line else self.source
            self.problems.append(": ".join(part for part in (place, column, message) if part))

    def where(
        self,
        wrong: BoolArray | np.bool_,
        lines: IntArray,
        say: str | Callable[[int], str],
        column: str = "",
    ) -> None:
        """Add a problem for each row of ``wrong (row,)``, in words or by its index."""
        rows = np.flatnonzero(wrong).tolist()
        told = rows[: max(MOST - self.count, 0)]
        for row in told:
            self.add(int(lines[row]), say if isinstance(say, str) else say(row), column)
        self.count += len(rows) - len(told)

    def check(self) -> None:
        """Raise `UserError` if anything is wrong."""
        if self.count > MOST:
            raise UserError([*self.problems, f"{self.source}: and {self.count - MOST} more"])
        if self.problems:
            raise UserError(self.problems)
