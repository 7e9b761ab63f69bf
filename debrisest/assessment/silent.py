"""Failures that nothing tells of."""

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
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
    if it is below zero, no minimum. Where ``doubt_at`` is known the same is said of each epoch of
    which it speaks, in ``silent_failure_at`` and ``doubtful_at``, both (run, time).
    """
    if "doubt" not in errors:
        return {}
    result: Data = {"doubtful": _doubtful(errors["doubt"])}
    if "doubt_at" in errors:
        result["doubtful_at"] = _doubtful(errors["doubt_at"])
    name = "w" if "w" in errors else "nees"
    if name in errors and f"{name}_dof" in errors:
        failed = _failed(errors, name)
        result["silent_failure"] = failed[:, -1] * (1.0 - result["doubtful"])
        if "doubtful_at" in result:
            result["silent_failure_at"] = failed * (1.0 - result["doubtful_at"])
    return result


def _doubtful(doubt: Array) -> Array:
    return np.where(np.isnan(doubt), np.nan, doubt > 0)


def _failed(errors: Data, name: str) -> BoolArray:
    """Return where (run, time) an estimate is wrong; so it is where nothing is known of it."""
    square, dof = errors[name], errors[f"{name}_dof"]
    failed = ~((square > _NO_MINIMUM) & (chance_above(square * dof, dof) > _CHANCE))
    if "deviation" in errors:
        failed |= errors["deviation"] > _SIGMAS
    return np.asarray(failed)
