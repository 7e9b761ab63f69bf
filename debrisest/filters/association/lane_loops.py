"""Covariances of several runs side by side, for compiled loops: the runs are the last axis.

A loop over that axis becomes vectors, so that eight runs cost what one does. A detection has two
components; symmetric matrices (2, 2) are held as xx, xy, yy.
"""

from debrisest.arrays import Array
from debrisest.compiled import compiled


@compiled
def multiplied(left: Array, right: Array, result: Array) -> None:
    """Write the products (n, m, run) of matrices (n, k, run) and (k, m, run)."""
    (rows, columns), lanes = result.shape[:2], result.shape[2]
    for i in range(rows):
        for j in range(columns):
            for r in range(lanes):
                result[i, j, r] = left[i, 0, r] * right[0, j, r]
            for k in range(1, len(right)):
                for r in range(lanes):
                    result[i, j, r] += left[i, k, r] * right[k, j, r]


@compiled
def advanced(transition: Array, columns: Array, scratch: Array) -> None:
    """Replace columns (n, m, run) by F times these."""
    multiplied(transition, columns, scratch)
    for i in range(columns.shape[0]):
        for j in range(columns.shape[1]):
            for r in range(columns.shape[2]):
                columns[i, j, r] = scratch[i, j, r]


@compiled
def predicted(
    transition: Array, noise: Array, factor: float, covariance: Array, scratch: Array
) -> None:
    """Replace P by F P F^T + ``factor`` Q; ``noise`` is Q (n, n), the others (n, n, run)."""
    multiplied(transition, covariance, scratch)
    n, lanes = covariance.shape[1:]
    for i in range(n):
        for j in range(i + 1):
            for r in range(lanes):
                covariance[i, j, r] = factor * noise[i, j]
            for k in range(n):
                for r in range(lanes):
                    covariance[i, j, r] += scratch[i, k, r] * transition[j, k, r]
            for r in range(lanes):
                covariance[j, i, r] = covariance[i, j, r]


@compiled
def shown(h: Array, covariance: Array, b: Array, cross: Array, own: Array) -> None:
    """Write b H P (2, n, run) and b^2 H P H^T (3, run)."""
    n, lanes = covariance.shape[1:]
    multiplied(h, covariance, cross)
    own[:] = 0.0
    for j in range(n):
        for r in range(lanes):
            cross[0, j, r] *= b[r]
            cross[1, j, r] *= b[r]
            own[0, r] += cross[0, j, r] * h[0, j, r] * b[r]
            own[1, r] += cross[0, j, r] * h[1, j, r] * b[r]
            own[2, r] += cross[1, j, r] * h[1, j, r] * b[r]


@compiled
def inverted(matrix: Array, result: Array) -> None:
    """Write the inverses (3, run)."""
    for r in range(matrix.shape[1]):
        determinant = matrix[0, r] * matrix[2, r] - matrix[1, r] * matrix[1, r]
        result[0, r] = matrix[2, r] / determinant
        result[1, r] = -matrix[1, r] / determinant
        result[2, r] = matrix[0, r] / determinant


@compiled
def scaled(matrix: Array, rows: Array, result: Array) -> None:
    """Write the products (2, n, run) of symmetric matrices (3, run) and rows (2, n, run)."""
    for j in range(rows.shape[1]):
        for r in range(rows.shape[2]):
            x, y = rows[0, j, r], rows[1, j, r]
            result[0, j, r] = matrix[0, r] * x + matrix[1, r] * y
            result[1, j, r] = matrix[1, r] * x + matrix[2, r] * y


@compiled
def corrected(gain: Array, cross: Array, total: Array, covariance: Array, scratch: Array) -> None:
    """Replace P by (I - K H) P (I - K H)^T + K R K^T.

    ``gain`` is K^T (2, n, run), ``cross`` H P, and ``total`` H P H^T + R (3, run), so that it is
    P - K D - D^T K^T with D = H P - (H P H^T + R) K^T / 2.
    """
    n, lanes = covariance.shape[1:]
    scaled(total, gain, scratch)
    for j in range(n):
        for r in range(lanes):
            scratch[0, j, r] = cross[0, j, r] - 0.5 * scratch[0, j, r]
            scratch[1, j, r] = cross[1, j, r] - 0.5 * scratch[1, j, r]
    for i in range(n):
        for j in range(i + 1):
            for r in range(lanes):
                less = gain[0, i, r] * scratch[0, j, r] + scratch[0, i, r] * gain[0, j, r]
                less += gain[1, i, r] * scratch[1, j, r] + scratch[1, i, r] * gain[1, j, r]
                covariance[i, j, r] -= less
                covariance[j, i, r] = covariance[i, j, r]
