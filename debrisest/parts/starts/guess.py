"""A start from what is known beforehand."""

from collections.abc import Collection
from typing import Literal

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.roles import StartPart

_PREFIX = "start_"


class FromGuess(StartPart):
    """A start that has the first guess of ``starts``, or of the measured file."""

    @classmethod
    def guessed(cls, given: Collection[str]) -> set[str]:
        """Return the quantities of which a first guess is given."""
        names = [name for name in given if name.startswith(_PREFIX)]
        return {name.removeprefix(_PREFIX) for name in names if not name.endswith("_sigma")}

    def start(self, data: Data, clock: Clock) -> tuple[Data, Data]:
        """Return the initial guess by name, and its variance by name."""
        names = sorted(self.guessed(data))
        guess: Data = {name: data[f"{_PREFIX}{name}"] for name in names}
        return guess, {name: data[f"{_PREFIX}{name}_sigma"] ** 2 for name in names}


class Guess(FromGuess):
    """The first guess as it stands."""

    kind: Literal["guess"]
