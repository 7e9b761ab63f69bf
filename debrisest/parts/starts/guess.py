"""A start from what is known beforehand."""

from collections.abc import Collection
from typing import Literal

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.roles import Positive, StartPart

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
    """The first guess as it stands, its sigma as it is told or as it is thought to be."""

    kind: Literal["guess"]
    sigma_factors: dict[str, Positive] = {}
    """What the estimator takes the sigma for over what it is, by quantity (such as `rate_b`)."""

    def start(self, data: Data, clock: Clock) -> tuple[Data, Data]:
        """Return the initial guess by name, and its variance by name."""
        guess, variance = super().start(data, clock)
        unknown = [name for name in self.sigma_factors if name not in guess]
        if unknown:
            raise ValueError(
                f"sigma_factors: no first guess of {', '.join(unknown)}; there are "
                f"{', '.join(guess)}"
            )
        scaled = {name: variance[name] * by**2 for name, by in self.sigma_factors.items()}
        return guess, variance | scaled
