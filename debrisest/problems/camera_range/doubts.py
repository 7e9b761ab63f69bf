"""What the model of a camera and a range takes for granted, as parameters that could be estimated.

Every doubt is an error that the model holds at zero: of the focal length, of the range, of the
camera's attitude, and constant accelerations and torques that it knows nothing of. Only derivatives
are needed: the self-tests ask how far from zero the residuals would pull each.
"""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.dynamics import clohessy_wiltshire
from debrisest.filters.doubt import Doubt
from debrisest.filters.landmark_model import Course, LandmarkModel, Rows
from debrisest.problems.camera_range import course
from debrisest.problems.camera_range.model import CameraRangeGeometry
from debrisest.problems.camera_range.projection import SHIFT, TURN, landmark_model
from debrisest.sensors import pinhole

_DEGREES = 180.0 / np.pi
_FOCAL = Doubt("the focal length seems {value} sigma off, by {size:+.2g} of it", 1.0)
_RANGE = Doubt("the range seems {value} sigma off, by {size:+.2g} m", 1.0)
_CAMERA = Doubt("the camera's attitude seems {value} sigma off, by {size:+.2g} deg", _DEGREES)
_PULL = Doubt("an acceleration of {size:+.2g} m/s^2 seems to be missing ({value} sigma)", 1.0)
_TORQUE = Doubt(
    "the rotation seems not to be free: {size:+.2g} deg/s^2 are missing ({value} sigma)",
    _DEGREES,
)
DOUBTS = (_FOCAL, _RANGE, *(_CAMERA,) * 3, *(_PULL,) * 3, *(_TORQUE,) * 3)
FOCAL, RANGE, CAMERA, PULL, TORQUE = (
    *(slice(0, 1), slice(1, 2), slice(2, 5), slice(5, 8)),
    slice(8, 11),
)


def doubtful_model(known: CameraRangeGeometry) -> LandmarkModel:
    """Return the problem for the landmark filters, with what it takes for granted."""
    model = landmark_model(known)
    return model._replace(
        doubts=DOUBTS,
        doubted=lambda: doubted(known, model),
        of=lambda runs: doubtful_model(known.of(runs)),
    )


def doubted(known: CameraRangeGeometry, model: LandmarkModel) -> LandmarkModel:
    """Return the model with errors of the `DOUBTS` behind those of its core, all of value zero.

    What it has of them are the slopes of the cost; it tells of no core where they would be.
    """
    count = len(DOUBTS)

    def with_doubts(parameters: Array, frames: IntArray) -> Course:
        core, by_parameters = model.start(parameters[..., :-count])
        cores, turning = course.moved(known, core, last := int(frames[-1]))
        found = course.over(known, by_parameters, cores, turning, frames)
        pulled, turned = _pulled(known, last), _turned(turning[..., :6], known.step)

        def by_start(part: slice) -> Array:
            wide = _widened(found.by_start(part))
            wide[..., SHIFT, -count:][..., PULL] = pulled[frames[part], :3]
            wide[..., TURN, -count:][..., TORQUE] = turned[:, frames[part], :3]
            return wide

        return Course(found.cores, by_start, found.last)

    def rows(cores: Array, points: Array, epochs: IntArray) -> Rows:
        return _doubted_rows(known, model.rows(cores, points, epochs))

    n_c = model.errors
    names = tuple(f"doubt_{i + 1}" for i in range(count))
    return model._replace(
        error_names=(*model.error_names[:n_c], *names, *model.error_names[n_c:]),
        course=with_doubts,
        rows=rows,
        shown_by=np.append(np.arange(n_c)[model.shown_by], n_c + np.arange(count)),
        doubted=None,
    )


def _widened(by_start: Array) -> Array:
    """The same (..., s, n_x) with the doubts behind its errors and its parameters."""
    s, n_x = by_start.shape[-2:]
    wide = np.zeros((*by_start.shape[:-2], s + len(DOUBTS), n_x + len(DOUBTS)))
    wide[..., :s, :n_x], wide[..., s:, n_x:] = by_start, np.eye(len(DOUBTS))
    return wide


def _doubted_rows(known: CameraRangeGeometry, found: Rows) -> Rows:
    pixels = found.shown[..., :2]
    static = np.zeros((*found.shown.shape, len(DOUBTS)))
    static[..., :2, FOCAL] = _apart_from(found.shared[..., :2, :], pixels)[..., None]
    static[..., 2:, RANGE] = 1.0
    if known.attitude == "known" and not known.camera_bias:
        sight = np.concatenate([pixels / known.focal, np.ones_like(pixels[..., :1])], axis=-1)
        static[..., :2, CAMERA] = pinhole.derivative(sight, known.focal) @ matrix_of_cross(sight)
    common = np.zeros((*found.common.shape, len(DOUBTS)))
    if known.range_model == "centre":
        common[..., RANGE] = 1.0
    return found._replace(
        by_core=np.concatenate([found.by_core, static], axis=-1),
        common_by_core=np.concatenate([found.common_by_core, common], axis=-1),
    )


def _apart_from(shared: Array, pixels: Array) -> Array:
    """Return what of pixels (..., N, 2) the noise that they share (..., N, 2, s) cannot make.

    Pixels that are predicted by a noisy attitude have its noise in them, as the residuals have: a
    product of both, such as the score of the focal length, would not be zero in the mean.
    """
    if shared.shape[-1] == 0:
        return pixels
    by = shared.reshape(*shared.shape[:-3], -1, shared.shape[-1])
    flat = pixels.reshape(*by.shape[:-1], 1)
    across = np.swapaxes(by, -1, -2)
    explained = by @ np.linalg.solve(across @ by, across @ flat)
    return np.asarray(pixels - explained.reshape(pixels.shape))


def _pulled(known: CameraRangeGeometry, last: int) -> Array:
    """Position and velocity (last + 1, 6, 3) by a constant acceleration of the chaser."""
    times = known.step * np.arange(last + 1.0)
    back = clohessy_wiltshire.transition(known.mean_motion, -times[1:])
    return _summed(clohessy_wiltshire.transition(known.mean_motion, times), back, known.step)


def _turned(transitions: Array, step: float) -> Array:
    """Attitude and rate (..., epoch, 6, 3) by a constant angular acceleration in body axes."""
    return _summed(transitions, np.asarray(np.linalg.inv(transitions[..., 1:, :, :])), step)


def _summed(transitions: Array, back: Array, step: float) -> Array:
    """Response (..., epoch, 6, 3) to a constant acceleration, which acts over each step."""
    kick = np.concatenate([0.5 * step**2 * np.eye(3), step * np.eye(3)])
    at_start = np.zeros((*transitions.shape[:-1], 3))
    at_start[..., 1:, :, :] = np.cumsum(back @ kick, axis=-3)
    return np.asarray(transitions @ at_start)
