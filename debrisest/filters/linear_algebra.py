"""Linear algebra of batched covariances in which no run can stop the others.

Unknowns of the `scaled` functions may differ by orders of magnitude.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray

_SMALLEST_RATIO = 1e-12
_SMALLEST_VARIANCE = 1e-30


def solve(matrix: Array, right: Array) -> Array:
    """Solution for every leading index; NaN where the matrix is singular."""
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
    except np.linalg.LinAlgError:
        sign, _ = np.linalg.slogdet(matrix)
        singular = ~(np.abs(sign) > 0.0)[..., None, None]
        solved = np.linalg.solve(np.where(singular, np.eye(matrix.shape[-1]), matrix), right)
        return np.where(singular, np.nan, solved)


def scaled_solve(matrix: Array, right: Array) -> Array:
    """Solution ``(run, n_e)``; NaN where the matrix is singular."""
    scale = np.diagonal(matrix, 0, -2, -1) ** -0.5
    scaled = scale[..., :, None] * matrix * scale[..., None, :]
    return scale * solve(scaled, (scale * right)[..., None])[..., 0]


def scaled_inverse(matrix: Array) -> Array:
    """Inverse ``(run, n_e, n_e)``, symmetric; NaN where the matrix is singular."""
    scale = np.diagonal(matrix, 0, -2, -1) ** -0.5
    both = scale[..., :, None] * scale[..., None, :]
    inverse = solve(both * matrix, np.broadcast_to(np.eye(matrix.shape[-1]), matrix.shape))
    return 0.5 * both * (inverse + np.swapaxes(inverse, -1, -2))


def inverse_of_some_rows(matrix: Array) -> Array:
    """Inverse ``(run, n_e, n_e)`` of matrices of which many rows are those of the unit matrix."""
    unit = np.eye(matrix.shape[-1])
    moved = np.flatnonzero((matrix != unit).any((0, 2)))
    rows, own = -matrix[:, moved], matrix[:, moved][..., moved]
    rows[..., moved] = np.eye(len(moved))
    inverse = np.repeat(unit[None], len(matrix), axis=0)
    inverse[:, moved] = solve(own, rows)
    return inverse


def square_root(covariance: Array) -> tuple[Array, BoolArray]:
    """Lower triangular factor per run, and which runs had to be repaired to have one."""
    try:
        root = np.asarray(np.linalg.cholesky(covariance), dtype=np.float64)
        return root, np.zeros(len(covariance), dtype=np.bool_)
    except np.linalg.LinAlgError:
        sound = np.array([_has_factor(matrix) for matrix in covariance])
    repaired: BoolArray = ~sound & np.isfinite(covariance).all((-2, -1))
    root = np.full_like(covariance, np.nan)
    root[sound] = np.linalg.cholesky(covariance[sound])
    root[repaired] = _nearest_factor(covariance[repaired])
    return root, repaired


def _has_factor(matrix: Array) -> bool:
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return False
    return True


def _nearest_factor(covariance: Array) -> Array:
    """Factor after clipping the eigenvalues at 1e-12 of the largest."""
    values, vectors = np.linalg.eigh(0.5 * covariance + 0.5 * np.swapaxes(covariance, -2, -1))
    floor = np.maximum(_SMALLEST_RATIO * values[:, -1:], _SMALLEST_VARIANCE)
    rows = np.sqrt(np.maximum(values, floor))[..., None] * np.swapaxes(vectors, -2, -1)
    return np.asarray(np.swapaxes(np.linalg.qr(rows, mode="r"), -2, -1), dtype=np.float64)
