"""Motion of a target relative to a leader on an elliptic orbit, in the leader's own axes.

Frame ``l``: origin in the leader, x radially outward, z along the orbit normal, y completes the
right-handed set (along track); it turns with the rate ``(0, 0, anomaly rate)``. Two-body motion of
both, without linearisation (Pesce et al. 2017, Eqs 7-15), with these corrections:

* Eqs 7, 11: gravity attracts, ``-mu (r + x) / R^3 + mu / r^2``; as printed, with the signs turned,
  the target is 86 km away after 100 s.
* Eq 9: the vector given is the leader's rate in ``l``, not in inertial axes.
* Eq 14: the square root does not extend over ``(1 + e cos)^2``.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array, IntArray
from debrisest.dynamics import kepler
from debrisest.dynamics.kepler import MU_EARTH


class Leader(NamedTuple):
    """The leader's orbit at a set of times, one array shape for all."""

    anomaly: Array
    """True anomaly, rad, without jumps of a whole turn from one time to the next."""
    radius: Array
    """Distance from the Earth's centre, m."""
    rate: Array
    """Time derivative of the true anomaly, rad/s."""
    acceleration: Array
    """Second time derivative of the true anomaly, rad/s^2."""

    def at(self, index: int | slice | IntArray) -> "Leader":
        """Return the orbit at one of the times, or at some of them."""
        return Leader(*(values[index] for values in self))


def leader_orbit(
    times: Array,
    semi_major_axis: float,
    eccentricity: float,
    true_anomaly: float,
    mu: float = MU_EARTH,
) -> Leader:
    """Leader at ``times (time,)``, s, which count from the moment of ``true_anomaly``, rad."""
    start = kepler.state_from_elements(
        semi_major_axis, eccentricity, 0.0, 0.0, 0.0, true_anomaly, mu
    )
    position, velocity = kepler.propagate(*start, times, mu)
    radius = np.linalg.norm(position, axis=-1)
    rate = np.sqrt(mu * semi_major_axis * (1.0 - eccentricity**2)) / radius**2
    climb = np.sum(position * velocity, axis=-1) / radius
    return Leader(
        anomaly=np.unwrap(np.arctan2(position[..., 1], position[..., 0])),
        radius=radius,
        rate=rate,
        acceleration=-2.0 * climb * rate / radius,
    )


def relative_acceleration(
    position: NDArray[Any], velocity: NDArray[Any], leader: Leader, mu: float = MU_EARTH
) -> NDArray[Any]:
    """Acceleration of ``position (..., 3)``, m, as seen in ``l``, m/s^2 (Eqs 11-13 and 15).

    ``velocity (..., 3)`` is the derivative of ``position`` as seen in ``l``; ``leader`` is the
    orbit at that moment and broadcasts against the leading axes.
    """
    x, y, z = position[..., 0], position[..., 1], position[..., 2]
    radius, rate, acceleration = leader.radius, leader.rate, leader.acceleration
    pull = mu * ((radius + x) ** 2 + y * y + z * z) ** -1.5
    square = rate * rate
    result = np.empty_like(position)
    result[..., 0] = (2.0 * rate * velocity[..., 1] + acceleration * y + square * x) + (
        mu / radius**2 - pull * (radius + x)
    )
    result[..., 1] = -2.0 * rate * velocity[..., 0] - acceleration * x + (square - pull) * y
    result[..., 2] = -pull * z
    return result


def translation_step(
    position: NDArray[Any],
    velocity: NDArray[Any],
    leader: tuple[Leader, Leader, Leader],
    step: float,
    mu: float = MU_EARTH,
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Position and velocity ``(..., 3)`` after one classical Runge-Kutta step of ``step`` s.

    ``leader`` is the orbit at the start, the middle and the end of the step, which may be negative.
    """
    start, middle, end = leader
    half = 0.5 * step
    a1 = relative_acceleration(position, velocity, start, mu)
    v2 = velocity + half * a1
    a2 = relative_acceleration(position + half * velocity, v2, middle, mu)
    v3 = velocity + half * a2
    a3 = relative_acceleration(position + half * v2, v3, middle, mu)
    v4 = velocity + step * a3
    a4 = relative_acceleration(position + step * v3, v4, end, mu)
    sixth = step / 6.0
    return (
        position + sixth * (velocity + 2.0 * (v2 + v3) + v4),
        velocity + sixth * (a1 + 2.0 * (a2 + a3) + a4),
    )


def transitions(leader: Leader, steps: Array, mu: float = MU_EARTH) -> Array:
    """Transition matrices ``(epoch, 6, 6)`` of position and velocity from the first epoch on.

    ``leader`` is the orbit at all epochs and midway between them, at ``2 epochs - 1`` times;
    ``steps (epoch - 1,)`` is the time from each epoch to the next, s. The motion is linearised
    at the leader itself, so that one set serves every target: the error is the ratio of the
    distance to the orbit's radius, about 1e-5, of what gravity's gradient contributes.
    """
    step_of_complex = 1e-30
    seeds = 1j * step_of_complex * np.eye(6)
    position, velocity = seeds[:, :3], seeds[:, 3:]
    result = [np.eye(6)]
    for epoch, step in enumerate(steps):
        k = 2 * epoch
        moments = leader.at(k), leader.at(k + 1), leader.at(k + 2)
        position, velocity = translation_step(position, velocity, moments, step, mu)
        result.append(np.concatenate([position, velocity], axis=-1).imag.T / step_of_complex)
    return np.array(result)
