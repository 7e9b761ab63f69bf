"""Arithmetic that leaves the numbers is an error in a sentence, unless a formula allows for it."""

import sys
from typing import Any

import numpy as np
from numpy.linalg import LinAlgError

FAILURES = (OverflowError, FloatingPointError, ZeroDivisionError, RuntimeWarning, LinAlgError)
"""What ordinary code raises of numbers that are far too large or too small."""
_ACT: Any = "warn" if sys.platform == "darwin" else "raise"
"""The matrix products of macOS (Accelerate) set the processor's flags without a reason."""


def strict() -> np.errstate:
    """Return a context in which an overflow, 1/0 and 0/0 raise FloatingPointError."""
    return np.errstate(over=_ACT, divide=_ACT, invalid=_ACT)


def told(error: Exception) -> str:
    """Return one of ``FAILURES`` as a sentence."""
    said = str(error).lower() or "no more is known"
    return f"its numbers do not work out ({said}); a value is too large or too small"
