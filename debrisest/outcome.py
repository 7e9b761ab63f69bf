"""Outcomes as values: enumerations whose members have a sentence that a user can act on."""

from enum import IntEnum
from typing import Self

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import IntArray


class Outcome(IntEnum):
    """How something ended: a code to compute with, and a ``sentence`` to show and to store."""

    sentence: str

    def __new__(cls, code: int, sentence: str) -> Self:
        """Return the member of a code, with its sentence."""
        member = int.__new__(cls, code)
        member._value_ = code
        member.sentence = sentence
        return member


def sentences(codes: IntArray, outcomes: type[Outcome]) -> NDArray[np.str_]:
    """Return the sentence of each code (run,)."""
    known = {outcome.value: outcome.sentence for outcome in outcomes}
    return np.array([known[code] for code in codes.tolist()])
