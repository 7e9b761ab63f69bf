"""Which features of a convex target face the observer."""

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.attitude import quaternion


def back_face_visible(
    points_b: Array, normals_b: Array, q_ib: Array, observer_i: Array
) -> BoolArray:
    """Whether each feature's surface faces the observer, ``(..., feature)``.

    Points from the centre of mass, m, and outward normals ``(..., feature, 3)`` in body axes;
    ``q_ib (..., 4)``; ``observer_i (..., 3)`` from the centre of mass in inertial axes, m. The line
    of sight is that of the feature, not of the centre of mass: near the target they differ.
    """
    observer_b = quaternion.rotate(quaternion.conjugate(q_ib), observer_i)
    sight = observer_b[..., None, :] - points_b
    return np.asarray(np.sum(sight * normals_b, axis=-1) > 0.0)
