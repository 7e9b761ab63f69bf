"""Linear algebra of one small positive matrix, for compiled loops."""

from debrisest.arrays import Array
from debrisest.compiled import compiled


@compiled
def solve(matrix: Array, right: Array) -> None:
    """Replace the right side (n) of a positive system (n, n) by its solution; spoils the matrix."""
    for k in range(len(right)):
        for i in range(k + 1, len(right)):
            share = matrix[k, i] / matrix[k, k]
            right[i] -= share * right[k]
            for j in range(i, len(right)):
                matrix[i, j] -= share * matrix[k, j]
    for k in range(len(right) - 1, -1, -1):
        for i in range(k + 1, len(right)):
            right[k] -= matrix[k, i] * right[i]
        right[k] /= matrix[k, k]
