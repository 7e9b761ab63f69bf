"""The pose that two cameras hardly tell from the right one where the target is far."""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import cross
from debrisest.problems.stereo_pose.model import POINTS, POSITION, RATE, VELOCITY, Q


def mirror(state: Array, points: int) -> Array:
    """Reverse the depth: the state that cameras infinitely far away could not tell from this one.

    Points and their velocities are reflected in the plane through their mean, across the line of
    sight to it, and so is the rate, an axial vector, and with opposite sign. ``state (..., n)``.
    The attitude, which no image shows, stays.
    """
    turn = quaternion.to_matrix(state[..., Q])
    arms = state[..., POINTS].reshape(*state.shape[:-1], points, 3) @ np.swapaxes(turn, -1, -2)
    arm, rate = arms.mean(-2), state[..., RATE]
    sight = state[..., POSITION] + arm
    sight = sight / np.linalg.norm(sight, axis=-1, keepdims=True)
    result = state.copy()
    result[..., POSITION] += _deeper(arm, sight)
    result[..., VELOCITY] += _deeper(cross(rate, arm), sight)
    result[..., RATE] = -rate + _deeper(rate, sight)
    result[..., POINTS] = ((arms - _deeper(arms, sight[..., None, :])) @ turn).reshape(
        state[..., POINTS].shape
    )
    return result


def _deeper(vector: Array, sight: Array) -> Array:
    """Twice the part of vectors along the unit vector ``sight``."""
    return np.asarray(2.0 * (vector * sight).sum(-1, keepdims=True) * sight)
