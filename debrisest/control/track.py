"""The target as satellites see it from their local orbital axes, between the epochs too."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.dynamics.local_frame import Axes, local_axes, normal_axis, orbital_rate


class Track(NamedTuple):
    """The target in the satellites' local orbital axes, (run, time, satellite, 3)."""

    point_o: Array
    """m."""
    velocity_o: Array
    """Its time derivative in these axes, m/s."""
    rate_o: Array
    """Rate of the axes, in these axes, rad/s."""


def seen_from(
    position: Array,
    velocity: Array,
    observer_position: Array,
    observer_velocity: Array,
    axes: Axes = "repaired",
) -> Track:
    """Return the track of a target ``(run, time, 3)`` seen by ``(run, time, satellite, 3)``.

    All states are inertial, m and m/s.
    """
    to_local = np.swapaxes(local_axes(observer_position, observer_velocity, axes), -1, -2)
    apart = position[..., None, :] - observer_position
    closing = velocity[..., None, :] - observer_velocity
    point = (to_local @ apart[..., None])[..., 0]
    rate = orbital_rate(observer_position, observer_velocity)[..., None] * normal_axis(axes)
    return Track(point, (to_local @ closing[..., None])[..., 0] - np.cross(rate, point), rate)


def between(track: Track, epoch: int, step: float, count: int) -> Array:
    """Points ``(count, run, satellite, 3)`` from an epoch on, evenly spaced to before the next.

    Cubic Hermite interpolation; ``step`` is the time to the next epoch, s.
    """
    u = (np.arange(count) / count)[:, None, None, None]
    start, end = track.point_o[:, epoch], track.point_o[:, epoch + 1]
    leaving, arriving = step * track.velocity_o[:, epoch], step * track.velocity_o[:, epoch + 1]
    bend = leaving + arriving - 2.0 * (end - start)
    return np.asarray(start + u * (leaving + u * (end - start - leaving - bend + u * bend)))
