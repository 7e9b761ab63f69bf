"""Local orbital axes of a satellite, from which its attitude is counted.

Source: Li et al., Eqs 2-3. The printed Eq 2 gives the axes (radially outward, transverse, orbit
normal), with which the debris lies behind both cameras of the paper's own table; the axes
(transverse, normal, radial) put it in view of both, one of them near the image's edge as the text
says, and are the default here.
"""

from typing import Literal

import numpy as np

from debrisest.arrays import Array
from debrisest.dynamics.relative_motion import hill_frame

Axes = Literal["repaired", "printed"]


def local_axes(position: Array, velocity: Array, axes: Axes = "repaired") -> Array:
    """``R_io (..., 3, 3)``, whose columns are the local orbital axes, of an inertial state.

    ``repaired``: transverse, orbit normal, radially outward. ``printed``: radially outward,
    transverse, orbit normal.
    """
    hill = hill_frame(position, velocity)
    return hill if axes == "printed" else np.roll(hill, -1, axis=-1)


def orbital_rate(position: Array, velocity: Array) -> Array:
    """Rate ``(...,)``, rad/s, at which the local axes turn about the orbit normal."""
    momentum = np.linalg.norm(np.cross(position, velocity), axis=-1)
    return np.asarray(momentum / np.sum(position**2, axis=-1))


def normal_axis(axes: Axes = "repaired") -> Array:
    """Orbit normal ``(3,)`` in the local axes."""
    return np.array([0.0, 1.0, 0.0] if axes == "repaired" else [0.0, 0.0, 1.0])
