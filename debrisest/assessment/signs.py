"""Whether the signs given to the pieces of a quaternion signal were right."""

import numpy as np

from debrisest.arrays import Array
from debrisest.recovery.pieces import continuous, signs_of_pieces


def signs_right(raw: Array, piece: Array, sign: Array, true: Array) -> Array:
    """Return the share (run,) of right decisions between successive pieces; 1 where there is none.

    ``raw`` and ``true`` are quaternions (run, time, 4), ``piece`` (run, time) is NaN between
    pieces, ``sign`` (run, piece) is NaN for pieces that a run lacks. The sign of the first piece
    is free, so that a decision is right if the sign changes from one piece to the next just
    where the samples' sign against a continuous truth does.
    """
    if not sign.shape[-1]:
        return np.ones(len(sign))
    smooth = continuous(true, np.zeros(piece.shape, dtype=np.int64))
    wanted = signs_of_pieces(raw, smooth, piece, sign.shape[-1])
    decided = np.isfinite(sign[..., 1:]) & np.isfinite(sign[..., :-1])
    given, true_turn = sign[..., 1:] * sign[..., :-1], wanted[..., 1:] * wanted[..., :-1]
    decisions = decided.sum(axis=-1)
    right = (decided & (given == true_turn)).sum(axis=-1)
    return np.where(decisions > 0, right / np.maximum(decisions, 1), 1.0)
