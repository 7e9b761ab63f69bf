"""The chi-square distribution, without the second that importing scipy.stats takes."""

from typing import Any

import numpy as np
import scipy

from debrisest.arrays import Array


def quantile(probability: Any, dof: Any) -> Array:
    """Value that is above a chi-square of ``dof`` degrees of freedom with a probability."""
    return np.asarray(2.0 * scipy.special.gammaincinv(0.5 * np.asarray(dof), probability))


def upper_quantile(probability: Any, dof: Any) -> Array:
    """Value that is below it with a probability."""
    return np.asarray(scipy.special.chdtri(dof, probability))


def chance_above(square: Array, dof: Array) -> Array:
    """Probability of a larger chi-square; zero without any degree of freedom."""
    chance = scipy.special.chdtrc(np.maximum(dof, 1), np.maximum(square, 0.0))
    return np.where(dof > 0, chance, 0.0)
