"""What a camera and a range finder show of a core and its points, with derivatives.

Symbols as in `debrisest.problems.camera_range.model`; A takes body axes to the camera's.
"""

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import cross, matrix_of_cross
from debrisest.dynamics.pointing import camera_axes
from debrisest.filters.landmark_model import LandmarkModel, Rows
from debrisest.problems.camera_range import course
from debrisest.problems.camera_range import model as motion
from debrisest.problems.camera_range.gauge import turn_of_axes
from debrisest.problems.camera_range.model import (
    ATTITUDE_ERROR,
    CORE,
    CORE_ERRORS,
    POSITION,
    POSITION_ERROR,
    CameraRangeGeometry,
    Q,
    error_names,
    turn_by_position,
)
from debrisest.sensors import pinhole

_NEAREST = 0.5
"""Depth, m, in place of a smaller or negative one, which no camera shows."""
TURN, SHIFT = slice(0, 3), slice(3, 6)
"""Attitude and position among the errors that rows depend on; constants of sensors follow."""


def landmark_model(known: CameraRangeGeometry) -> LandmarkModel:
    """Return the problem for the landmark filters."""
    ranged = known.range_model == "landmark"
    pixel = np.full(2, known.pixel_sigma)
    return LandmarkModel(
        landmarks=known.points,
        rows_each=2 + ranged,
        common=int(not ranged),
        held=3,
        sigma=np.append(pixel, known.range_sigma) if ranged else pixel,
        common_sigma=np.full(int(not ranged), known.range_sigma),
        error_names=error_names(known),
        shown_by=np.r_[ATTITUDE_ERROR, POSITION_ERROR, CORE_ERRORS : CORE_ERRORS + known.extras],
        start=lambda parameters: motion.start(known, parameters),
        parameters=lambda core: core[..., 4:].copy(),
        mirror=motion.mirror,
        path=lambda core, last: course.path(known, core, last),
        course=lambda parameters, frames: course.course(known, parameters, frames),
        trajectory=lambda core, last: course.trajectory(known, core, last),
        process=lambda core: course.process(known, core),
        rows=lambda cores, points, epochs: rows(known, cores, points, epochs),
        place=lambda cores, shown, epochs: place(known, cores, shown, epochs),
        retract=motion.retract,
        difference=motion.difference,
        of=lambda runs: landmark_model(known.of(runs)),
        gauge=turn_of_axes,
    )


def rows(known: CameraRangeGeometry, cores: Array, points: Array, epochs: IntArray) -> Rows:
    """Pixels and ranges of cores ``(run, epoch, n)`` and points ``(run, 1, N, 3)``."""
    shown, by_core, by_point, by_bias = _pixels(known, cores, points, epochs)
    noisy, none = known.attitude_sigma > 0.0, np.zeros((*cores.shape[:-1], 0))
    found = Rows(
        shown=shown,
        by_core=by_core,
        by_point=by_point,
        common=none,
        common_by_core=np.zeros((*none.shape, by_core.shape[-1])),
        shared=known.attitude_sigma * by_bias if noisy else by_bias[..., :0],
    )
    if known.range_model == "landmark":
        return _with_ranges(found, cores, points)
    return _with_range(known, found, cores)


def _pixels(
    known: CameraRangeGeometry, cores: Array, points: Array, epochs: IntArray
) -> tuple[Array, Array, Array, Array]:
    """Pixels, and their derivatives by errors, by points, and by a turn of the camera, if any."""
    errors, turned = 6 + known.extras, known.attitude_sigma > 0.0 or known.camera_bias
    to_camera = _to_camera(known, cores, epochs)
    if compiled.available():
        from debrisest.problems.camera_range.projection_loops import pixels

        implied = known.attitude == "implied"
        by_position = turn_by_position(cores[..., POSITION]) if implied else to_camera
        return pixels(
            np.ascontiguousarray(cores),
            np.ascontiguousarray(np.broadcast_to(points[:, 0], (len(cores), *points.shape[2:]))),
            np.ascontiguousarray(np.broadcast_to(to_camera, (*cores.shape[:2], 3, 3))),
            np.ascontiguousarray(by_position),
            (known.focal, _NEAREST),
            implied,
            known.camera_bias,
            (errors, 3 * turned),
        )
    turn = to_camera @ quaternion.to_matrix(cores[..., Q])
    arm = points @ np.swapaxes(turn, -1, -2)
    point = arm - _seen(to_camera, cores[..., POSITION])[..., None, :]
    point[..., 2] = np.maximum(point[..., 2], _NEAREST)
    by_point = pinhole.derivative_through(point, known.focal, turn[..., None, :, :])
    by_position = _by_position(known, cores, to_camera, arm)
    by_core = np.zeros((*by_point.shape[:-1], errors))
    by_core[..., TURN] = cross(points[..., None, :], by_point)
    by_core[..., SHIFT] = pinhole.derivative_through(point, known.focal, by_position)
    by_bias = by_point[..., :0]
    if turned:
        by_bias = pinhole.derivative_through(point, known.focal, matrix_of_cross(point))
    if known.camera_bias:
        by_core[..., -3:] = by_bias
    return pinhole.project(point, known.focal), by_core, by_point, by_bias


def _to_camera(known: CameraRangeGeometry, cores: Array, epochs: IntArray) -> Array:
    """``R_ch (run, epoch, 3, 3)``."""
    if known.attitude == "implied":
        return np.swapaxes(camera_axes(cores[..., POSITION]), -1, -2)
    to_camera = np.swapaxes(known.camera[:, epochs], -1, -2)
    if known.camera_bias:
        to_camera = quaternion.to_matrix(quaternion.exp(-cores[..., -3:])) @ to_camera
    return to_camera


def _seen(to_camera: Array, rho: Array) -> Array:
    return (to_camera @ rho[..., None])[..., 0]


def _by_position(known: CameraRangeGeometry, cores: Array, to_camera: Array, arm: Array) -> Array:
    """Derivative ``(..., N or 1, 3, 3)`` of a point in the camera by the chaser's position."""
    if known.attitude == "known":
        return -to_camera[..., None, :, :]
    rho = cores[..., POSITION]
    result = matrix_of_cross(arm) @ turn_by_position(rho)[..., None, :, :]
    result[..., 2, :] += (rho / np.linalg.norm(rho, axis=-1, keepdims=True))[..., None, :]
    return np.asarray(result)


def _with_range(known: CameraRangeGeometry, found: Rows, cores: Array) -> Rows:
    """Add the range to the centre of mass, or to a surface that is nearer by a constant."""
    rho = cores[..., POSITION]
    distance = np.sqrt((rho * rho).sum(-1, keepdims=True))
    by_core = np.zeros((*distance.shape, found.by_core.shape[-1]))
    by_core[..., SHIFT] = (rho / distance)[..., None, :]
    if known.range_model == "bias":
        by_core[..., 6] = -1.0
        distance = distance - cores[..., CORE : CORE + 1]
    return found._replace(common=distance, common_by_core=by_core)


def _with_ranges(found: Rows, cores: Array, points: Array) -> Rows:
    """Add to every landmark the distance from it as its third row."""
    turn = quaternion.to_matrix(cores[..., Q])
    away = points @ np.swapaxes(turn, -1, -2) - cores[..., None, POSITION]
    distance = np.linalg.norm(away, axis=-1, keepdims=True)
    along = away / distance
    by_point = along @ turn
    by_core = np.zeros((*by_point.shape[:-1], found.by_core.shape[-1]))
    by_core[..., TURN] = cross(points, by_point)
    by_core[..., SHIFT] = -along
    shared = np.concatenate([found.shared, np.zeros_like(found.shared[..., :1, :])], axis=-2)
    return found._replace(
        shown=np.concatenate([found.shown, distance], axis=-1),
        by_core=np.concatenate([found.by_core, by_core[..., None, :]], axis=-2),
        by_point=np.concatenate([found.by_point, by_point[..., None, :]], axis=-2),
        shared=shared,
    )


def place(
    known: CameraRangeGeometry, cores: Array, shown: Array, epochs: IntArray
) -> tuple[Array, Array, Array]:
    """Points ``(run, N, 3)`` at the depth of the centre of mass, on the line of their pixels.

    With cores ``(run, N, n)``, pixels ``(run, N, 2 or 3)`` and epochs ``(run, N)``, one each; and
    the points' derivative by the core's errors, and the covariance ``(run, N, 3, 3)`` that pixels
    and unknown depth add.
    """
    rho = cores[..., POSITION]
    distance = np.linalg.norm(rho, axis=-1, keepdims=True)
    outward = (rho / distance)[..., None, :]
    slope = np.concatenate([shown[..., :2] / known.focal, np.ones_like(distance)], axis=-1)
    view = slope * distance
    n_c = CORE_ERRORS + known.extras
    by_core = np.zeros((*rho.shape, n_c))
    if known.attitude == "implied":
        to_hill = camera_axes(rho)
        side = view - distance * np.array([0.0, 0.0, 1.0])
        by_core[..., POSITION_ERROR] = to_hill @ (
            -matrix_of_cross(side) @ turn_by_position(rho)
            + side[..., None] * outward / distance[..., None]
        )
        arm_h = (to_hill @ side[..., None])[..., 0]
    else:
        to_hill = known.camera[np.arange(len(rho))[:, None], epochs]
        if known.camera_bias:
            to_hill = to_hill @ quaternion.to_matrix(quaternion.exp(cores[..., -3:]))
            by_core[..., -3:] = -to_hill @ matrix_of_cross(view)
        arm_h = (to_hill @ view[..., None])[..., 0] + rho
        by_core[..., POSITION_ERROR] = np.eye(3) + (to_hill @ slope[..., None]) * outward
    to_body = np.swapaxes(quaternion.to_matrix(cores[..., Q]), -1, -2)
    points = (to_body @ arm_h[..., None])[..., 0]
    by_core = to_body @ by_core
    by_core[..., ATTITUDE_ERROR] = matrix_of_cross(points)
    across = (distance * np.hypot(known.pixel_sigma / known.focal, known.attitude_sigma))[..., None]
    spread = (
        to_body
        @ to_hill
        @ np.concatenate(
            [across * np.eye(3)[:, :2], (known.depth_sigma * slope)[..., None]], axis=-1
        )
    )
    return points, by_core, spread @ np.swapaxes(spread, -1, -2)
