"""What a search for signs believes: penalties of recovered signals (Biondi et al. 2017, Eq. 28)."""

from collections.abc import Callable

import numpy as np

from debrisest.arrays import Array
from debrisest.recovery.basis_pursuit import Recovered
from debrisest.recovery.fourier import l1_norm, multiplicity

Score = Callable[[Recovered], Array]
"""Penalty (...) of recovered signals; the hypothesis with the lowest one is believed."""


def lasso_score(solution: Recovered) -> Array:
    """Penalty (...): the objective of the lasso (Eq. 19), which the recovery minimises."""
    return solution.objective


def sparsity_score(
    solution: Recovered,
    count_weight: float = 1.0,
    modulus_weight: float = 10.0,
    threshold: float = 1e-2,
) -> Array:
    """Penalty (...) of Eq. 28, const1 |c|_0 + const2 |c|_1 of the recovered signal's spectrum.

    The paper gives neither the weights nor the modulus from which a coefficient is not zero.
    """
    large = (np.abs(solution.coefficients) > threshold) @ multiplicity(solution.length)
    modulus = l1_norm(solution.coefficients, solution.length)
    return count_weight * large + modulus_weight * modulus
