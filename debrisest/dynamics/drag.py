"""Drag of an exponential atmosphere that turns with the Earth, in Earth-centred inertial axes."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array

EARTH_TURN = 7.292115e-5
"""rad/s, about the third axis."""


class Drag(NamedTuple):
    """An atmosphere about a body: its density falls by e over a scale height."""

    ballistic: float
    """Drag coefficient times area over mass, m^2/kg."""
    density: float
    """At ``radius``, kg/m^3."""
    radius: float
    """From the Earth's centre, m."""
    scale_height: float
    """m."""


def drag_acceleration(position: Array, velocity: Array, drag: Drag) -> Array:
    """Acceleration ``(..., 3)``, m/s^2: ``-1/2 rho B |v| v``, ``v`` relative to the air.

    Source: D. A. Vallado, Fundamentals of Astrodynamics and Applications, Sec. 8.6.2.
    """
    x, y = position[..., 0], position[..., 1]
    air = EARTH_TURN * np.stack([-y, x, np.zeros_like(x)], axis=-1)
    through = velocity - air
    height = np.linalg.norm(position, axis=-1) - drag.radius
    density = drag.density * np.exp(-height / drag.scale_height)
    pressure = 0.5 * density * drag.ballistic * np.linalg.norm(through, axis=-1)
    return np.asarray(-pressure[..., None] * through)
