"""Errors of an estimated attitude."""

from typing import Any

from numpy.typing import NDArray

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.attitude.euler import pitch
from debrisest.attitude.points import features_frame


def true_feature_attitude(data: dict[str, NDArray[Any]]) -> Array:
    """Return the true attitude (run, time, 4) of the frame built on the first three features."""
    q_bf = quaternion.from_matrix(features_frame(data["true_point_b"]))[:, None]
    return quaternion.multiply(data["true_q_ib"], q_bf)


def attitude_errors(q_if: Array, true_q_if: Array) -> tuple[Array, Array]:
    """Return the pitch error and the angle of the attitude error (...), in radians.

    Pitch is that of the feature frame in inertial axes, since a filter's body axes are known only
    up to a relabeling; both errors are free of the quaternions' signs.
    """
    return pitch(q_if) - pitch(true_q_if), quaternion.angle_between(true_q_if, q_if)
