"""Pose, rates and inertia ratios of an unknown target from the pixels of two cameras.

Frames: ``l`` of the leader, which carries the cameras (see `debrisest.dynamics.relative_orbit`),
``t`` of the target, its principal axes. The state (15 + 3N) is the centre of mass in ``l`` and its
velocity (Pesce et al. 2017: rho, rho-dot), the target's rate relative to ``l``, in ``l`` (omega),
``q_lt`` (q; D takes target axes to ``l``), the inertia ratios ``k`` and N points in ``t`` (P_i).
Departures from the printed equations:

* Everywhere D is divided by the square of the quaternion's norm; with ``raw_rotation`` it is not,
  and a filter then uses the norm as a free scale of the cloud of points.
* Eqs 7-18: see `debrisest.dynamics.relative_orbit` and `debrisest.dynamics.relative_rotation`.
* Eqs 24-27: see `debrisest.sensors.stereo`.
* Eq 37: what is measured is the angular acceleration of the target in ``t``.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array, IntArray
from debrisest.attitude.vectors import cross
from debrisest.clock import Clock
from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.relative_orbit import Leader, leader_orbit, translation_step
from debrisest.dynamics.relative_rotation import rotate, rotation_step, unrotate
from debrisest.sensors import stereo

POSITION, VELOCITY, RATE = slice(0, 3), slice(3, 6), slice(6, 9)
Q, K, POINTS = slice(9, 13), slice(13, 15), slice(15, None)


class Shown(NamedTuple):
    """Which groups of measurements there are."""

    pixels: bool = True
    flow: bool = True
    disparity: bool = True
    acceleration: bool = False


EVERYTHING_OF_CAMERAS = Shown()


class StereoGeometry(NamedTuple):
    """What is known without error: orbit, cameras, number of points; and the time steps, s."""

    leader: Leader
    """At epoch 0 and every half step after it."""
    steps: Array
    """From each epoch to the next, (epoch - 1,)."""
    points: int = 5
    baseline: float = 1.0
    shown: Shown = EVERYTHING_OF_CAMERAS
    raw_rotation: bool = False
    to_camera: Array | None = None
    """Turns the leader's axes into the cameras', (3, 3); none: these are the same."""

    @property
    def times(self) -> Array:
        """Return the time of every epoch since the first, s."""
        return np.concatenate([[0.0], np.cumsum(self.steps)])

    @property
    def rows(self) -> IntArray:
        """Return the rows of `stereo.measure` that each point has."""
        groups = (self.shown.pixels, self.shown.flow, self.shown.disparity)
        slices = (stereo.PIXELS, stereo.FLOW, stereo.DISPARITY)
        every = np.arange(stereo.ROWS)
        return np.concatenate([every[rows] for on, rows in zip(groups, slices) if on] + [every[:0]])

    def moments_of_step(self, k: int, direction: int = 1) -> tuple[Leader, Leader, Leader]:
        """Return the leader at start, middle and end of the step from epoch k (or back)."""
        index = 2 * k
        return (
            self.leader.at(index),
            self.leader.at(index + direction),
            self.leader.at(index + 2 * direction),
        )


def stereo_geometry(
    clock: Clock,
    semi_major_axis: float,
    eccentricity: float,
    true_anomaly: float,
    points: int = 5,
    baseline: float = 1.0,
    shown: Shown = EVERYTHING_OF_CAMERAS,
    raw_rotation: bool = False,
    to_camera: Array | None = None,
) -> StereoGeometry:
    """Return the geometry at the clock's epochs (time zero at the true anomaly), SI and rad."""
    epochs = np.arange(len(clock.times))
    times = np.interp(np.arange(2 * len(epochs) - 1) / 2, epochs, clock.times)
    leader = leader_orbit(times, semi_major_axis, eccentricity, true_anomaly)
    return StereoGeometry(leader, clock.steps, points, baseline, shown, raw_rotation, to_camera)


def process(known: StereoGeometry, state: NDArray[Any], k: int) -> NDArray[Any]:
    """States ``(..., n)`` one step after epoch ``k``."""
    leader = known.moments_of_step(k)
    following = state.copy()
    following[..., POSITION], following[..., VELOCITY] = translation_step(
        state[..., POSITION], state[..., VELOCITY], leader, known.steps[k]
    )
    following[..., RATE], following[..., Q] = rotation_step(
        state[..., RATE],
        state[..., Q],
        inertia_ratios.slopes(state[..., K]),
        leader,
        known.steps[k],
        known.raw_rotation,
    )
    return following


def points_in_view(
    state: NDArray[Any], points: int, raw: bool = False
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Points and their velocities ``(..., N, 3)`` in ``l`` (Eqs 19-21)."""
    body = state[..., POINTS].reshape(*state.shape[:-1], points, 3)
    arm = rotate(state[..., None, Q], body, raw)
    velocity = state[..., None, VELOCITY] + cross(state[..., None, RATE], arm)
    return state[..., None, POSITION] + arm, velocity


def shown_of_points(
    known: StereoGeometry, point: NDArray[Any], velocity: NDArray[Any]
) -> NDArray[Any]:
    """What the cameras show ``(..., rows)`` of points and velocities ``(..., 3)`` in ``l``."""
    if known.to_camera is not None:
        point, velocity = point @ known.to_camera.T, velocity @ known.to_camera.T
    return stereo.measure(point, velocity, known.baseline)[..., known.rows]


def shown_by_points(known: StereoGeometry, point: Array, velocity: Array) -> Array:
    """Derivative ``(..., rows, 6)`` of `shown_of_points` by points and velocities."""
    turn = known.to_camera
    if turn is None:
        return stereo.jacobian(point, velocity, known.baseline)[..., known.rows, :]
    turned = stereo.jacobian(point @ turn.T, velocity @ turn.T, known.baseline)[..., known.rows, :]
    return np.concatenate([turned[..., :3] @ turn, turned[..., 3:] @ turn], axis=-1)


def target_acceleration(
    known: StereoGeometry, state: NDArray[Any], k: int | IntArray
) -> NDArray[Any]:
    """Angular acceleration of the target ``(..., 3)`` in ``t``, rad/s^2, at epoch ``k``."""
    total = state[..., RATE].copy()
    total[..., 2] += known.leader.rate[2 * k]
    rate_t = unrotate(state[..., Q], total, known.raw_rotation)
    return inertia_ratios.angular_acceleration(rate_t, state[..., K])


def measurement(known: StereoGeometry, state: NDArray[Any], k: int | IntArray) -> NDArray[Any]:
    """Measurements ``(..., m)``: point by point, then the angular acceleration.

    ``k`` is the epoch of all states, or those of the last of their leading axes.
    """
    point, velocity = points_in_view(state, known.points, known.raw_rotation)
    rows = shown_of_points(known, point, velocity).reshape(*state.shape[:-1], -1)
    if not known.shown.acceleration:
        return rows
    return np.concatenate([rows, target_acceleration(known, state, k)], axis=-1)


def error_names(attitude: str, points: int) -> tuple[str, ...]:
    """Return the names of the errors; ``attitude`` holds those of the attitude, spaced."""
    axes = ("x", "y", "z")
    vectors = [f"{name}_{axis}" for name in ("position", "velocity", "rate") for axis in axes]
    features = [f"point_{i + 1}_{axis}" for i in range(points) for axis in axes]
    return (*vectors, *attitude.split(), "k1", "k2", *features)
