"""Failures that nothing tells of."""

import numpy as np

from debrisest.arrays import Data
from debrisest.assessment.chi_square import chance_above

_CHANCE = 5.7e-7
"""Of five sigma of a normal variable, on both sides."""
_NO_MINIMUM = -1e-2
_SIGMAS = 5.0


def silent_failures(errors: Data) -> Data:
    """Return ``silent_failure (run,)`` and ``doubtful (run,)``, as far as there are figures.

    A run fails where its normalised error squared at the end is one that a right covariance has
    once in two million times, or is not finite, or where one of its numbers is off by more than
    five of its sigmas (`deviation`); silently, if ``doubt`` is zero. Where costs are known it is
    `chart_free` in place of that square, which no choice of coordinates can bend; the run fails too
    if it is below zero, no minimum.
    """
    if "doubt" not in errors:
        return {}
    doubtful = errors["doubt"] > 0
    result: Data = {"doubtful": doubtful.astype(np.float64)}
    name = "w" if "w" in errors else "nees"
    if name in errors and f"{name}_dof" in errors:
        square, dof = errors[name][:, -1], errors[f"{name}_dof"][:, -1]
        failed = ~((square > _NO_MINIMUM) & (chance_above(square * dof, dof) > _CHANCE))
        if "deviation" in errors:
            failed |= errors["deviation"][:, -1] > _SIGMAS
        result["silent_failure"] = (failed & ~doubtful).astype(np.float64)
    return result
