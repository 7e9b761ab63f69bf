"""What the stereo pose problem takes for granted and the images can speak against.

The scale of all slopes, which is an error of the focal length, and that no torque acts.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.filters.replay_model import Doubt
from debrisest.problems.stereo_pose.model import Q, StereoGeometry

_TURNED = slice(6, 12)
"""Plain errors of rate and attitude."""


def doubts(known: StereoGeometry) -> tuple[Doubt, ...]:
    """Return the doubts: the focal length, and a constant angular acceleration about each axis."""
    focal = Doubt(
        "the images fit better with a focal length that is larger by {size:.2g} % ({value} sigma)",
        100.0,
        lambda _, __, shown, ___: _of_cameras(known, shown),
    )
    return (focal, *(_torque(known, axis) for axis in range(3)))


def _torque(known: StereoGeometry, axis: int) -> Doubt:
    return Doubt(
        f"the motion fits better with a torque about principal axis {axis + 1} that gives "
        "{size:.2g} deg/s^2 ({value} sigma)",
        180.0 / np.pi,
        lambda states, turning, _, derivative: _pushed(known, states, turning, derivative, axis),
    )


def _of_cameras(known: StereoGeometry, shown: Array) -> Array:
    """Slopes and their rates grow with the focal length; the angular acceleration does not."""
    result = shown.copy()
    result[..., known.points * len(known.rows) :] = 0.0
    return result


def _pushed(
    known: StereoGeometry, states: Array, turning: Array, derivative: Array, axis: int
) -> Array:
    """Derivative (run, epoch, m) by an acceleration about an axis, by variation of constants.

    ``turning (run, epoch, 6, 8)`` takes errors at the start to those of an epoch: its inverse takes
    what is added on the way back to the start, of which ``derivative (..., m, n_e)`` is known.
    """
    back = np.linalg.inv(turning[..., :6])
    push = back[..., :3] @ quaternion.to_matrix(states[..., Q])[..., axis : axis + 1]
    each = 0.5 * known.steps[: states.shape[1] - 1, None] * (push[:, 1:, :, 0] + push[:, :-1, :, 0])
    at_start = np.zeros((*push.shape[:3], 1))
    np.cumsum(each, axis=1, out=at_start[:, 1:, :, 0])
    return np.asarray((derivative[..., _TURNED] @ at_start)[..., 0])
