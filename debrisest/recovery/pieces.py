"""Pieces of a signal with missing samples (Biondi et al. 2017, Secs. 2 and 4).

A piece is a maximal run of observed epochs. Inside a piece the sign of a quaternion follows from
continuity; between pieces it does not, and has to be searched for.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray


def pieces(observed: BoolArray) -> IntArray:
    """Index (..., time) of the piece that each epoch of `observed` (..., time) belongs to.

    Pieces are counted from 0 in order of time, separately for every signal; -1 is "not observed".
    """
    counted = np.cumsum(_starts(observed), axis=-1, dtype=np.int64) - 1
    return np.where(observed, counted, -1)


def continuous(q: Array, piece: IntArray) -> Array:
    """Quaternions `q` (..., time, 4) with signs such that they are continuous in every piece.

    Successive quaternions of a piece (..., time) get a dot product that is not negative; the first
    one of a piece keeps its sign. The whole quaternion is flipped: the rule in step 3 of Sec. 2
    flips the vector part alone, which would be another attitude. NaN stays NaN.
    """
    products = np.sum(q[..., 1:, :] * q[..., :-1, :], axis=-1)
    turns = np.ones(piece.shape)
    turns[..., 1:][(products < 0) & (piece[..., 1:] == piece[..., :-1])] = -1.0
    sign: Array = np.multiply.accumulate(turns, axis=-1)
    return q * (sign * _at_start(sign, piece))[..., None]


def signs_of_pieces(q: Array, smooth: Array, piece: Array | IntArray, count: int) -> Array:
    """Sign (..., count) of the pieces of `q` (..., time, 4) against a continuous `smooth`.

    That of the sum of their dot products over each piece; NaN for pieces that a signal lacks.
    `piece` (..., time) is negative or NaN where nothing is observed.
    """
    product = np.nan_to_num(np.sum(q * smooth, axis=-1))
    member = piece[..., None] == np.arange(count)
    total = np.einsum("...tp,...t->...p", member, product)
    return np.where(member.any(axis=-2), np.where(total < 0, -1.0, 1.0), np.nan)


def _starts(observed: BoolArray) -> BoolArray:
    """Epochs that are observed while the one before is not."""
    starts = observed.copy()
    starts[..., 1:] &= ~observed[..., :-1]
    return starts


def _at_start(values: Array, piece: IntArray) -> Array:
    """For every epoch the value (..., time) at the first epoch of its piece."""
    epoch = np.where(_starts(piece >= 0), np.arange(piece.shape[-1]), 0)
    return np.take_along_axis(values, np.maximum.accumulate(epoch, axis=-1), axis=-1)
