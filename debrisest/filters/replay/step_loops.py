"""Steps of Gauss-Newton as plain loops, for `debrisest.compiled`."""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.linear_algebra_loops import factor, factor_solve


@compiled
def steps(information: Array, gradient: Array, prior: Array, damping: Array) -> Array:
    """Return the steps (run, n_e) that ``information (run, n_e, n_e)`` gives.

    It is damped by a part (run,) of that of the ``prior``.
    """
    result, matrix = gradient.copy(), np.empty(information.shape[1:])
    for run in range(len(gradient)):
        for a in range(len(matrix)):
            for b in range(a, len(matrix)):
                matrix[a, b] = information[run, a, b] + damping[run] * prior[run, a, b]
        factor(matrix)
        factor_solve(matrix, result[run])
    return result
