"""Motion of a chaser relative to its target, in the Hill frame and in inertial axes.

The Hill frame ``h`` has its axes radially outward, along track and along the orbit normal.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.dynamics import kepler


def hill_frame(position: Array, velocity: Array) -> Array:
    """``R_ih (..., 3, 3)``, whose columns are the Hill frame's axes, of an inertial state."""
    radial = position / np.linalg.norm(position, axis=-1, keepdims=True)
    momentum = np.cross(position, velocity)
    normal = momentum / np.linalg.norm(momentum, axis=-1, keepdims=True)
    return np.stack([radial, np.cross(normal, radial), normal], axis=-1)


def hold(position: Array, velocity: Array, offset_h: Array) -> Array:
    """Chaser position from the target ``(..., 3)``, inertial axes, for a fixed Hill offset."""
    return np.asarray((hill_frame(position, velocity) @ offset_h[..., None])[..., 0])


def drift(
    position0: Array,
    velocity0: Array,
    offset_h: Array,
    velocity_h: Array,
    times: Array,
    mu: float = kepler.MU_EARTH,
) -> tuple[Array, Array]:
    """Relative position and velocity ``(..., time, 3)``, inertial axes, of a free chaser.

    It starts at ``offset_h`` from the target, m, with ``velocity_h`` as seen in the rotating Hill
    frame, m/s. Both orbits are propagated exactly, so that no distance is too long.
    """
    frame = hill_frame(position0, velocity0)
    offset = (frame @ offset_h[..., None])[..., 0]
    momentum = np.cross(position0, velocity0)
    rate = momentum / np.sum(position0**2, axis=-1, keepdims=True)
    closing = (frame @ velocity_h[..., None])[..., 0] + np.cross(rate, offset)
    target = kepler.propagate(position0, velocity0, times, mu)
    chaser = kepler.propagate(position0 + offset, velocity0 + closing, times, mu)
    return chaser[0] - target[0], chaser[1] - target[1]
