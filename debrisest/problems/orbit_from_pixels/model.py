"""Orbit of a piece of debris, seen as one of several points by the cameras of satellites.

The state is position and velocity of the debris (6), Earth-centred inertial, and if wanted the
errors of the cameras' known attitudes (3 each), rotation vectors ``beta`` in camera axes that do
not change: ``R_known = R_true exp[beta x]``. Two-body motion, with an acceleration that is drawn
anew for each step; a pinhole camera (Li et al., Eqs 1-7).

We depart from the printed equations where these cannot be right: Eq 15 propagates the covariance
with A of the differential equation, here with the transition over a step; Eqs 2-3 take axes with
which the debris is behind the cameras (see `debrisest.dynamics.local_frame`); Eq 7 does not test
the depth, here nothing is predicted for what is behind a camera. The offset of Eq 5 is zero.
"""

from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.dynamics import perturbed_orbit
from debrisest.filters.doubt import Doubt
from debrisest.filters.scan_model import ScanModel
from debrisest.sensors import pinhole

ORBIT = slice(0, 6)


class ObserverGeometry(NamedTuple):
    """What the estimator knows beside the detections."""

    step: float
    observer: Array
    """Positions (time, run, observer, 3)."""
    to_camera: Array
    """Inertial to camera axes, (time, run, observer, 3, 3)."""
    scale: Array
    """Focal length in pixels, (run,)."""
    acceleration_noise: Array
    """1 sigma () or (3,), inertial axes, constant over a step, m/s^2."""
    pixel_variance: Array
    """Of each coordinate, () or (2,)."""
    with_bias: bool

    def of(self, runs: IntArray) -> "ObserverGeometry":
        """Return what is known of some runs."""
        return self._replace(
            observer=self.observer[:, runs],
            to_camera=self.to_camera[:, runs],
            scale=self.scale[runs],
        )


def scan_model(known: ObserverGeometry) -> ScanModel:
    """Return the model of one clock step."""
    observers = known.observer.shape[2]
    fast = compiled.available() and known.step <= perturbed_orbit.LONGEST_STEP
    names = [f"{part}_{axis}" for part in ("position", "velocity") for axis in "xyz"]
    if known.with_bias:
        names += [f"bias_{s + 1}_{axis}" for s in range(observers) for axis in "xyz"]
    return ScanModel(
        process=lambda state, k: process(known, state),
        process_jacobian=lambda state, k: process_jacobian(known, state),
        process_noise=process_noise(known, len(names)),
        points=lambda state, k: points(known, state, k),
        points_jacobian=lambda state, k: points_jacobian(known, state, k),
        noise=known.pixel_variance * np.eye(2),
        error_names=tuple(names),
        doubts=doubts(known),
        doubted=lambda state, k: doubted(known, state, k),
        select=lambda runs: scan_model(known.of(runs)),
        both=(lambda state, _: _both(known, state)) if fast else None,
        all_seen=(lambda state, k: _all_seen(known, state, k)) if fast else None,
    )


def _both(known: ObserverGeometry, state: Array) -> tuple[Array, Array]:
    from debrisest.problems.orbit_from_pixels import model_loops

    return model_loops.both(state, known.step)


def _all_seen(known: ObserverGeometry, state: Array, k: int) -> tuple[Array, Array, Array]:
    from debrisest.problems.orbit_from_pixels import model_loops

    cameras = known.observer[k], known.to_camera[k], known.scale
    return model_loops.all_seen(state, *cameras, len(doubts(known)))


def process(known: ObserverGeometry, state: Array) -> Array:
    """Return the states (run, ..., n) a step later; biases stay."""
    orbit = perturbed_orbit.advance(state[..., ORBIT], known.step)
    return np.concatenate([orbit, state[..., 6:]], axis=-1)


def process_jacobian(known: ObserverGeometry, state: Array) -> Array:
    """Return the derivative (run, ..., n, n) of `process`."""
    moved = perturbed_orbit.transition(state[..., ORBIT], known.step)
    if not known.with_bias:
        return moved
    n = state.shape[-1]
    result = np.zeros((*state.shape, n))
    result[..., :, :] = np.eye(n)
    result[..., ORBIT, ORBIT] = moved
    return result


def process_noise(known: ObserverGeometry, n: int) -> Array:
    """Return the covariance (n, n), of rank 3, that an acceleration adds which lasts a step."""
    by_acceleration = np.zeros((n, 3))
    by_acceleration[:3] = 0.5 * known.step**2 * np.eye(3)
    by_acceleration[3:6] = known.step * np.eye(3)
    return np.asarray(known.acceleration_noise**2 * by_acceleration @ by_acceleration.T)


def points(known: ObserverGeometry, state: Array, k: int) -> Array:
    """Return the pixels (run, ..., observer, 2), NaN of what is not in front of the camera."""
    return _pixels(known, _in_camera(known, state, k))


def points_jacobian(known: ObserverGeometry, state: Array, k: int) -> Array:
    """Return the derivative (run, ..., observer, 2, n) of `points`."""
    point = _in_camera(known, state, k)
    by_point = pinhole.derivative(point, _like(known.scale[:, None], state))
    by_point = np.where(point[..., 2, None, None] > 0.0, by_point, np.nan)
    turn = _like(known.to_camera[k], state)
    result = np.zeros((*point.shape[:-1], 2, state.shape[-1]))
    if known.with_bias:
        bias = _bias(known, state)
        turn = quaternion.to_matrix(quaternion.exp(bias)) @ turn
        by_bias = -by_point @ matrix_of_cross(point) @ _left_jacobian(bias)
        for s in range(bias.shape[-2]):
            result[..., s, :, 6 + 3 * s : 9 + 3 * s] = by_bias[..., s, :, :]
    result[..., :3] = by_point @ turn
    return result


def doubts(known: ObserverGeometry) -> tuple[Doubt, ...]:
    """Return what is taken for granted: the focal length, and attitudes that are not estimated."""
    focal = Doubt("the focal length seems {value} sigma off, by {size:+.2g} of it", 1.0)
    cameras = range(0 if known.with_bias else known.observer.shape[2])
    said = "the attitude of camera {0} seems {{value}} sigma off, by {{size:+.2g}} mrad"
    return (focal, *(Doubt(said.format(s + 1), 1e3) for s in cameras for _ in range(3)))


def doubted(known: ObserverGeometry, state: Array, k: int) -> Array:
    """Return the derivative (run, ..., observer, 2, doubt) of `points` by the `doubts`."""
    point = _in_camera(known, state, k)
    cameras = point.shape[-2]
    result = np.zeros((*point.shape[:-1], 2, 1 if known.with_bias else 1 + 3 * cameras))
    result[..., 0] = _pixels(known, point)
    if not known.with_bias:
        by_point = pinhole.derivative(point, _like(known.scale[:, None], state))
        by_attitude = -by_point @ matrix_of_cross(point)
        for s in range(cameras):
            result[..., s, :, 1 + 3 * s : 4 + 3 * s] = by_attitude[..., s, :, :]
    return result


def _in_camera(known: ObserverGeometry, state: Array, k: int) -> Array:
    """Debris (run, ..., observer, 3) in camera axes."""
    away = state[..., None, :3] - _like(known.observer[k], state)
    point = (_like(known.to_camera[k], state) @ away[..., None])[..., 0]
    return (
        quaternion.rotate(quaternion.exp(_bias(known, state)), point) if known.with_bias else point
    )


def _pixels(known: ObserverGeometry, point: Array) -> Array:
    scale = known.scale.reshape(-1, *[1] * (point.ndim - 2))
    return np.where(point[..., 2:] > 0.0, pinhole.project(point, scale), np.nan)


def _bias(known: ObserverGeometry, state: Array) -> Array:
    """Biases (run, ..., observer, 3)."""
    return state[..., 6:].reshape(*state.shape[:-1], known.observer.shape[2], 3)


def _like(values: Array, state: Array) -> Array:
    """Insert axes after the run for those that states (run, ..., n) have between."""
    return values.reshape(len(values), *[1] * (state.ndim - 2), *values.shape[1:])


def _left_jacobian(vector: Array) -> Array:
    """Turn of ``exp(vector)`` per change of a small rotation vector, to its second order."""
    cross = matrix_of_cross(vector)
    return np.asarray(np.eye(3) + 0.5 * cross + cross @ cross / 6.0)
