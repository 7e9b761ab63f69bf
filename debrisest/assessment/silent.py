"""Failures that nothing tells of."""

import numpy as np

from debrisest.arrays import Array, Data

_CHANCE = 5.7e-7
"""Of five sigma of a normal variable, on both sides."""


def silent_failures(errors: Data) -> Data:
    """Return ``silent_failure (run,)`` and ``doubtful (run,)``, as far as there are figures.

    A run fails where its normalised error squared at the end is one that a right covariance has
    once in two million times, or is not finite; silently, if ``doubt`` is zero.
    """
    if "doubt" not in errors:
        return {}
    doubtful = errors["doubt"] > 0
    result: Data = {"doubtful": doubtful.astype(np.float64)}
    if "nees" in errors and "nees_dof" in errors:
        failed = ~(_chance(errors["nees"][:, -1], errors["nees_dof"][:, -1]) > _CHANCE)
        result["silent_failure"] = (failed & ~doubtful).astype(np.float64)
    return result


def _chance(nees: Array, dof: Array) -> Array:
    """Probability of a larger square per dimension (run,); zero without any."""
    from scipy.stats import chi2

    return np.where(dof > 0, chi2.sf(nees * dof, np.maximum(dof, 1)), 0.0)
