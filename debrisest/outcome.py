"""Outcomes as values: enumerations whose members have a sentence that a user can act on."""

from collections.abc import Iterable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import IntArray


class Outcome(Protocol):
    """A member of such an enumeration."""

    value: int
    sentence: str


def sentences(codes: IntArray, outcomes: Iterable[Outcome]) -> NDArray[np.str_]:
    """Return the sentence of each code (run,)."""
    known = {outcome.value: outcome.sentence for outcome in outcomes}
    return np.array([known[code] for code in codes.tolist()])
