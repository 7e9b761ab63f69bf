"""The target in the axes that a camera had at time zero, where its own axes are unknown.

Such axes ``e``, fixed in the body, are exact by definition; an unknown target has no others.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.dynamics.relative_motion import hill_frame


class InStartFrame(NamedTuple):
    """Truth in the axes ``e``."""

    q_he: Array
    """Attitude to the Hill frame, (run, time, 4)."""
    rate: Array
    """Inertial rate, rad/s, (run, time, 3)."""
    point: Array
    """Features from the centre of mass, m, (run, feature, 3)."""
    inertia: Array
    """Tensor, kg m^2, (run, 3, 3)."""


def attitude_in_hill(data: Data) -> Array:
    """Return the true attitude (run, time, 4) of the body's own axes to the Hill frame."""
    q_ih = quaternion.from_matrix(hill_frame(data["orbit_position"], data["orbit_velocity"]))
    return quaternion.multiply(quaternion.conjugate(q_ih), data["true_q_ib"])


def in_start_frame(data: Data, q_hc: Array) -> InStartFrame:
    """Return the truth in the axes of the camera at time zero, ``q_hc (run, 4)`` to Hill axes."""
    q_hb = attitude_in_hill(data)
    q_eb = quaternion.multiply(quaternion.conjugate(q_hc), q_hb[:, 0])
    turn = quaternion.to_matrix(q_eb)
    back = np.swapaxes(turn, -1, -2)
    return InStartFrame(
        q_he=quaternion.multiply(q_hb, quaternion.conjugate(q_eb)[:, None]),
        rate=data["true_rate_b"] @ back,
        point=data["true_point_b"] @ back,
        inertia=turn @ data["true_inertia_b"] @ back,
    )
