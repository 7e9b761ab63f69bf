"""Cores over the epochs, from that of epoch 0, and how their errors follow from the start's.

Rotation and translation do not depend on each other in the Hill frame: the centre's motion is
linear, and its derivative the same for all runs; the rotation is integrated.
"""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.dynamics import clohessy_wiltshire, tumbling_in_orbit
from debrisest.filters.landmark_model import Course
from debrisest.problems.camera_range.model import (
    CORE_ERRORS,
    LOG_INERTIA,
    LOG_INERTIA_ERROR,
    POSITION,
    POSITION_ERROR,
    RATE,
    RATE_ERROR,
    VELOCITY,
    VELOCITY_ERROR,
    CameraRangeGeometry,
    Q,
    start,
)

_TURNING = np.r_[0 : RATE_ERROR.stop, LOG_INERTIA_ERROR]
"""Errors that the rotation depends on."""
_TURNED = RATE.stop
_MOVING = slice(POSITION.start, VELOCITY.stop)
_MOVING_ERROR = slice(POSITION_ERROR.start, VELOCITY_ERROR.stop)
_RATES, _CENTRES, _RATIOS = slice(0, 3), slice(3, 9), slice(9, 14)
"""Their places among the parameters of a start."""
_LARGEST_TURN = 0.125
"""Angle, rad, up to which one Runge-Kutta step of order 4 is far below what pixels show."""
_MOST_SUBSTEPS = 64.0
_TOGETHER = 600
"""Steps of all runs whose sensitivities are computed at once: as many as stay in the cache."""


def path(known: CameraRangeGeometry, core: Array, last: int) -> Array:
    """Cores ``(run, last + 1, n)`` from that of epoch 0."""
    return moved(known, core, last, False)[0]


def course(known: CameraRangeGeometry, parameters: Array, frames: IntArray) -> Course:
    """Cores of a start's ``parameters (run, n_x)``, and what their errors are by these."""
    core, by_parameters = start(known, parameters)
    return over(known, by_parameters, *moved(known, core, int(frames[-1])), frames)


def over(
    known: CameraRangeGeometry,
    by_parameters: Array,
    cores: Array,
    turning: Array,
    frames: IntArray,
) -> Course:
    """Course over some epochs of what `moved` gives, from errors (run, n_c, n_x) of the start."""
    centre = clohessy_wiltshire.transition(known.mean_motion, known.step * frames.astype(float))
    last = _transitions(known, turning[:, -1], centre[-1]) @ by_parameters

    def by_start(part: slice) -> Array:
        turned = turning[:, frames[part], :3]
        shape = (*turned.shape[:2], 6 + known.extras, by_parameters.shape[-1])
        result = np.zeros(shape)
        result[..., :3, _RATES], result[..., :3, _RATIOS] = turned[..., 3:6], turned[..., 6:]
        if known.attitude == "implied":
            result[..., :3, :] += turned[..., :3] @ by_parameters[:, None, :3]
        result[..., 3:6, _CENTRES] = centre[part, :3]
        result[..., 6:, 14:] = np.eye(known.extras)
        return result

    return Course(cores[:, frames], by_start, last)


def trajectory(known: CameraRangeGeometry, core: Array, last: int) -> tuple[Array, Array]:
    """Cores ``(run, last + 1, n)`` from that of epoch 0, and errors by those of epoch 0."""
    cores, turning = moved(known, core, last)
    centre = clohessy_wiltshire.transition(known.mean_motion, known.step * np.arange(last + 1.0))
    return cores, _transitions(known, turning, centre)


def process(known: CameraRangeGeometry, core: Array) -> tuple[Array, Array]:
    """Core ``(run, n)`` one step later, and the derivative ``(run, n_c, n_c)`` of its errors."""
    after = core.copy()
    turning = np.empty((len(core), tumbling_in_orbit.TURNING, 11))
    for count, runs in _by_substeps(known, core):
        turned, by_start = rotation(known, core[runs], 1, count)
        after[runs, :_TURNED], turning[runs] = turned[:, 1], by_start[:, 1]
    centre = _one_step(known.mean_motion, known.step)
    after[..., _MOVING] = core[..., _MOVING] @ centre.T
    return after, _transitions(known, turning, centre)


@lru_cache
def _one_step(mean_motion: float, step: float) -> Array:
    """Transition (6, 6) of the centre over one epoch."""
    return clohessy_wiltshire.transition(mean_motion, step)


def moved(
    known: CameraRangeGeometry, core: Array, last: int, sensitive: bool = True
) -> tuple[Array, Array]:
    """Cores ``(run, last + 1, n)``, and the errors of their rotation by those of epoch 0.

    The latter are (run, last + 1, 6, 11), of no epoch where they are not wanted.
    """
    cores = np.empty((len(core), last + 1, core.shape[-1]))
    cores[:] = core[:, None]
    turning = np.empty((len(core), (last + 1) * sensitive, tumbling_in_orbit.TURNING, 11))
    for count, runs in _by_substeps(known, core):
        cores[runs, :, :_TURNED], turning[runs] = rotation(
            known, core[runs], last, count, sensitive
        )
    centre = clohessy_wiltshire.transition(known.mean_motion, known.step * np.arange(last + 1.0))
    cores[..., _MOVING] = (centre @ core[:, None, _MOVING, None])[..., 0]
    return cores, turning


def _by_substeps(known: CameraRangeGeometry, core: Array) -> Iterator[tuple[int, IntArray]]:
    """Numbers of Runge-Kutta steps in one epoch, powers of two, and the runs that need them."""
    turn = np.sqrt((core[..., RATE] ** 2).sum(-1)) * known.step / _LARGEST_TURN
    halvings = np.ceil(np.log2(np.fmin(np.fmax(turn, 1.0), _MOST_SUBSTEPS)))
    for halving in sorted(set(halvings.tolist())):
        yield int(2**halving), np.flatnonzero(halvings == halving)


def rotation(
    known: CameraRangeGeometry, core: Array, last: int, count: int, sensitive: bool = True
) -> tuple[Array, Array]:
    """Attitude and rate (run, last + 1, 7), and their errors by those of epoch 0."""
    if compiled.available():
        from debrisest.dynamics.log_inertia_loops import with_derivative
        from debrisest.dynamics.tumbling_in_orbit_loops import rotation

        pace = known.mean_motion, 3.0 * known.mean_motion**2 * known.gravity_gradient
        start = np.ascontiguousarray(core[..., :_TURNED])
        body = with_derivative(np.ascontiguousarray(core[..., LOG_INERTIA]))
        return rotation(start, *body, pace, known.step / count, last, count, sensitive)
    shape = tumbling_in_orbit.body(core[..., LOG_INERTIA])
    products = tumbling_in_orbit.torque_products(shape)
    q, w, n, duration = core[..., Q], core[..., RATE], known.mean_motion, known.step / count
    turned = np.empty((len(core), last + 1, _TURNED))
    rates, radials = (np.empty((len(core), last * count, 4, 3)) for _ in range(2))
    for k in range(last * count):
        if k % count == 0:
            turned[:, k // count, Q], turned[:, k // count, RATE] = q, w
        q, w, stages = tumbling_in_orbit.step(
            q, w, shape, n, duration, products, known.gravity_gradient
        )
        rates[:, k], radials[:, k] = stages
    turned[:, last, Q], turned[:, last, RATE] = q, w
    if not sensitive:
        return turned, np.empty((len(core), 0, tumbling_in_orbit.TURNING, 11))
    body = tumbling_in_orbit.Body(*(part[:, None] for part in shape))
    steps = np.empty((len(core), last * count, tumbling_in_orbit.TURNING, 11))
    together = max(1, _TOGETHER // len(core))
    for k in range(0, last * count, together):
        part = slice(k, k + together)
        stages = tumbling_in_orbit.Stages(rates[:, part], radials[:, part])
        steps[:, part] = tumbling_in_orbit.sensitivity(
            stages, body, n, duration, known.gravity_gradient
        )
    return turned, _composed(steps)[:, ::count]


def _composed(steps: Array) -> Array:
    """Products ``(run, epoch + 1, 6, 11)`` of the steps ``(run, epoch, 6, 11)`` so far."""
    result = np.empty((len(steps), steps.shape[1] + 1, 6, 11))
    result[:, 0] = np.eye(6, 11)
    for k in range(steps.shape[1]):
        result[:, k + 1] = steps[:, k, :, :6] @ result[:, k]
        result[:, k + 1, :, 6:] += steps[:, k, :, 6:]
    return result


def _transitions(known: CameraRangeGeometry, turning: Array, centre: Array) -> Array:
    """Derivative ``(..., n_c, n_c)`` of rotation ``(..., 6, 11)`` and centre ``(..., 6, 6)``."""
    n_c = CORE_ERRORS + known.extras
    result = np.zeros((*turning.shape[:-2], n_c, n_c))
    result[...] = np.eye(n_c)
    result[..., :6, _TURNING] = turning
    result[..., _MOVING_ERROR, _MOVING_ERROR] = centre
    return result
