"""An attitude signal from its nine direction cosines, which know no sign.

q and -q have the same rotation matrix: its entries are continuous over every gap, and nothing has
to be searched for. The price is a richer spectrum, since the entries are products of the
quaternion's components.
"""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.attitude.rotation import nearest_rotation
from debrisest.recovery.pieces import continuous, signs_of_pieces


def entries(matrix: Array) -> Array:
    """The direction cosines (..., time, 9) of rotation matrices (..., time, 3, 3), row by row."""
    return matrix.reshape(*matrix.shape[:-2], 9)


def attitude_of(cosines: Array) -> Array:
    """Quaternions (..., time, 4), continuous over all epochs, of recovered entries (..., time, 9).

    Each epoch gets the rotation nearest to its matrix, NaN where the matrix is zero.
    """
    matrix, scale = nearest_rotation(cosines.reshape(*cosines.shape[:-1], 3, 3))
    q = quaternion.from_matrix(np.where(scale[..., 1:2, None] > 0, matrix, np.nan))
    return continuous(q, np.zeros(q.shape[:-1], np.int64))


def signs_from(q: Array, raw: Array, piece: IntArray) -> tuple[Array, Array]:
    """Signs (run, piece) of the pieces of `raw` (run, time, 4) against a signal `q` without gaps.

    Returns also `q` (run, time, 4) itself, with the sign that makes the first piece's +1. `piece`
    (run, time) is -1 where nothing is observed; pieces that a run lacks have NaN.
    """
    sign = signs_of_pieces(raw, q, piece, int(piece.max(initial=-1)) + 1)
    if not sign.shape[-1]:
        return q, sign
    first = np.nan_to_num(sign[:, :1], nan=1.0)
    return q * first[..., None], sign * first
