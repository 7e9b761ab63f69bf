"""The turn of the body axes, which neither the motion nor a camera nor a range can tell.

Turned by ``e``, in body axes, the attitude is ``q exp(e)`` and everything that is fixed in the body
turns back: rate and points by ``v x e``, the inertia by ``[S, [e]x]``, S being its logarithm.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.dynamics import log_inertia
from debrisest.problems.camera_range.model import (
    ATTITUDE_ERROR,
    LOG_INERTIA,
    LOG_INERTIA_ERROR,
    RATE,
    RATE_ERROR,
)


def turn_of_axes(core: Array, points: Array) -> Array:
    """Errors ``(run, n_c + 3 N, 3)`` of a core ``(run, n)`` and points ``(run, N, 3)`` by e."""
    runs, n_c = len(core), core.shape[-1] - 1
    errors = np.zeros((runs, n_c, 3))
    errors[:, ATTITUDE_ERROR] = np.eye(3)
    errors[:, RATE_ERROR] = matrix_of_cross(core[:, RATE])
    errors[:, LOG_INERTIA_ERROR] = log_inertia.by_turn(core[:, LOG_INERTIA])
    of_points = matrix_of_cross(points).reshape(runs, -1, 3)
    return np.concatenate([errors, of_points], axis=1)
