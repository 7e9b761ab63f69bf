"""Two-body motion around the Earth, in inertial axes (ECI)."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array

MU_EARTH = 3.986004418e14  # m^3/s^2


def state_from_elements(
    semi_major_axis: Array | float,
    eccentricity: Array | float,
    inclination: Array | float,
    raan: Array | float,
    argument_of_periapsis: Array | float,
    true_anomaly: Array | float,
    mu: float = MU_EARTH,
) -> tuple[Array, Array]:
    """Position and velocity ``(..., 3)``, m and m/s, of elements in m and rad that broadcast."""
    a, e = np.asarray(semi_major_axis), np.asarray(eccentricity)
    if np.any((e < 0.0) | (e >= 1.0) | (a <= 0.0)):
        raise ValueError("elements must describe an ellipse: semi-major axis > 0, eccentricity < 1")
    parameter = a * (1.0 - e**2)
    node, periapsis, anomaly = (np.asarray(x) for x in (raan, argument_of_periapsis, true_anomaly))
    latitude = periapsis + anomaly
    radial, along = _in_plane_axes(node, np.asarray(inclination), latitude)
    radius = parameter / (1.0 + e * np.cos(anomaly))
    speed = np.sqrt(mu / parameter)
    climb, advance = speed * e * np.sin(anomaly), speed * (1.0 + e * np.cos(anomaly))
    position = radius[..., None] * radial
    return position, climb[..., None] * radial + advance[..., None] * along


def _in_plane_axes(node: Array, inclination: Array, latitude: Array) -> tuple[Array, Array]:
    """Unit vectors at an argument of latitude: radially outward and along the motion."""
    towards_node = _stack(np.cos(node), np.sin(node), np.zeros_like(node))
    ahead_of_node = _stack(
        -np.sin(node) * np.cos(inclination),
        np.cos(node) * np.cos(inclination),
        np.sin(inclination),
    )
    cosine, sine = np.cos(latitude)[..., None], np.sin(latitude)[..., None]
    return (
        cosine * towards_node + sine * ahead_of_node,
        cosine * ahead_of_node - sine * towards_node,
    )


def _stack(x: Array, y: Array, z: Array) -> Array:
    return np.stack(np.broadcast_arrays(x, y, z), axis=-1)


def shape_and_anomaly(
    position: Array, velocity: Array, mu: float = MU_EARTH
) -> tuple[float, float, float]:
    """Semi-major axis, m, eccentricity and true anomaly, rad, of an elliptic orbit's state (3,).

    On a circle, where the anomaly is counted from no point in particular, it is any number.
    """
    radius = float(np.linalg.norm(position))
    momentum = float(np.linalg.norm(np.cross(position, velocity)))
    axis = 1.0 / (2.0 / radius - float(velocity @ velocity) / mu)
    e_cos = momentum**2 / (mu * radius) - 1.0
    e_sin = momentum * float(position @ velocity) / (mu * radius)
    return axis, float(np.hypot(e_cos, e_sin)), float(np.arctan2(e_sin, e_cos))


class Ellipse(NamedTuple):
    """An elliptic orbit through a state, and what stays along it, each ``(..., 1)``."""

    position: Array
    """At time zero ``(..., 3)``, as the velocity."""
    velocity: Array
    radius: Array
    axis: Array
    motion: Array
    """Mean, rad/s."""
    e_cos: Array
    """Eccentricity times the cosine of the eccentric anomaly at time zero."""
    e_sin: Array

    def positions(self, times: Array) -> Array:
        """Positions ``(..., time, 3)`` at ``times (time,)``."""
        return self._at(*self._turned(times))

    def states(self, times: Array) -> tuple[Array, Array]:
        """Positions and velocities ``(..., time, 3)``, by Lagrange coefficients."""
        cosine, sine = self._turned(times)
        new_radius = self.axis * (1.0 - self.e_cos * cosine + self.e_sin * sine)
        f_dot = -self.motion * self.axis**2 / (self.radius * new_radius) * sine
        g_dot = 1.0 - self.axis / new_radius * (1.0 - cosine)
        return self._at(cosine, sine), self._sum(f_dot, g_dot)

    def _turned(self, times: Array) -> tuple[Array, Array]:
        advance = _anomaly_advance(self.motion * times, self.e_cos, self.e_sin)
        return np.cos(advance), np.sin(advance)

    def _at(self, cosine: Array, sine: Array) -> Array:
        f = 1.0 - self.axis / self.radius * (1.0 - cosine)
        g = (self.radius / self.axis * sine + self.e_sin * (1.0 - cosine)) / self.motion
        return self._sum(f, g)

    def _sum(self, f: Array, g: Array) -> Array:
        start, heading = self.position[..., None, :], self.velocity[..., None, :]
        return np.asarray(f[..., None] * start + g[..., None] * heading)


def ellipse(position: Array, velocity: Array, mu: float = MU_EARTH) -> Ellipse:
    """Orbit through a state ``(..., 3)``; raise ValueError where it is open."""
    position, velocity = np.broadcast_arrays(position, velocity)
    radius = np.linalg.norm(position, axis=-1, keepdims=True)
    energy = 0.5 * np.sum(velocity**2, axis=-1, keepdims=True) - mu / radius
    if np.any(energy >= 0.0):
        raise ValueError("the orbit is open: only elliptic orbits are propagated")
    axis = -0.5 * mu / energy
    e_sin = np.sum(position * velocity, axis=-1, keepdims=True) / np.sqrt(mu * axis)
    motion = np.sqrt(mu / axis**3)
    return Ellipse(position, velocity, radius, axis, motion, 1.0 - radius / axis, e_sin)


def propagate(
    position: Array, velocity: Array, times: Array, mu: float = MU_EARTH
) -> tuple[Array, Array]:
    """Position and velocity ``(..., time, 3)`` at ``times (time,)`` after a state of an ellipse."""
    return ellipse(position, velocity, mu).states(times)


def _anomaly_advance(mean_advance: Array, e_cos: Array, e_sin: Array) -> Array:
    """Advance of the eccentric anomaly from a start where ``e cos E`` and ``e sin E`` are known.

    Newton's iteration on Kepler's equation, from a start that converges for every ellipse.
    """
    eccentricity, start = np.hypot(e_cos, e_sin), np.arctan2(e_sin, e_cos)
    mean = start - e_sin + mean_advance
    mean = mean - 2.0 * np.pi * np.round(mean / (2.0 * np.pi))
    anomaly = mean + 0.85 * eccentricity * np.sign(mean)
    for _ in range(50):
        residual = anomaly - eccentricity * np.sin(anomaly) - mean
        step = residual / (1.0 - eccentricity * np.cos(anomaly))
        anomaly = anomaly - step
        if not np.any(np.abs(step) > 1e-14):
            break
    return np.asarray(anomaly - start)
