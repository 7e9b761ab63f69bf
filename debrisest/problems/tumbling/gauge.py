"""Estimates of a body of unknown geometry in the true feature frame.

Their own frame is fixed in the body and otherwise free (gauge); the rotation that lays the
estimated points over the true ones takes it to the frame of the first three features.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.assessment.shape_alignment import best_rotation
from debrisest.attitude import quaternion
from debrisest.attitude.points import features_frame


def in_true_frame(data: Data) -> Data:
    """Return the data with ``q_bf (run, time, 4)`` as it is in the true feature frame."""
    estimated, true = data["point_f"], data["true_point_b"]
    known: BoolArray = np.asarray(np.isfinite(estimated).all(axis=-1, keepdims=True))
    to_body = best_rotation(_centred(estimated, known), _centred(true, known))
    frame = features_frame(true)
    q_mine_true = quaternion.from_matrix(np.swapaxes(to_body, -1, -2) @ frame)
    q_bf = quaternion.multiply(data["q_bf"], q_mine_true[:, None])
    return data | {"q_bf": q_bf}


def _centred(points: Array, known: BoolArray) -> Array:
    """Points (run, feature, 3) from the mean of those that are known."""
    count = np.maximum(known.sum(axis=-2, keepdims=True), 1)
    mean = np.sum(points, axis=-2, keepdims=True, where=known) / count
    return np.where(known, points - mean, np.nan)
