"""An arc of torque-free motion: eleven unknowns at one epoch, and what they say of all others.

The unknowns are the attitude ``q_if``, the rate in the feature frame ``f``, rad/s, and the inertia
in ``f`` as five log-ratios (`debrisest.dynamics.log_inertia`). Their errors (11) are a rotation
vector in inertial axes, applied from the left, and differences: an error of the attitude is the
same at all epochs, and none of the rate.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.dynamics import log_inertia
from debrisest.dynamics.torque_free import torque_free

TURN, RATE, INERTIA = slice(0, 3), slice(3, 6), slice(6, 11)
UNKNOWNS = 11
TURN_OF_STEP = 2e-5
"""How far a difference's step turns the body at the end of the arc, about, rad."""


class Arc(NamedTuple):
    """Motion by its state at ``epoch``, s; leading axes of the arrays are copies."""

    epoch: float
    q: Array
    """``q_if (..., 4)``."""
    rate: Array
    """In the feature frame, rad/s, (..., 3)."""
    log_inertia: Array
    """(..., 5)."""


class Course(NamedTuple):
    """Arcs at given times, with their derivatives by the errors of the unknowns."""

    q: Array
    """(..., time, 4)."""
    rate: Array
    """(..., time, 3), rad/s."""
    turn_by: Array
    """(..., time, 3, 11), in inertial axes."""
    rate_by: Array
    """(..., time, 3, 11), in the feature frame."""


def along(arc: Arc, times: Array) -> tuple[Array, Array]:
    """Return ``q_if (..., time, 4)`` and rates ``(..., time, 3)`` at ``times (time,)``, s."""
    if compiled.available():
        return _along_compiled(arc, times)
    moments, axes = log_inertia.principal(arc.log_inertia)
    q_fb = quaternion.from_matrix(axes)
    rate_b = (arc.rate[..., None, :] @ axes)[..., 0, :]
    q_ib, rates_b = torque_free(
        times - arc.epoch, quaternion.multiply(arc.q, q_fb), rate_b, moments
    )
    q_if = quaternion.multiply(q_ib, quaternion.conjugate(q_fb)[..., None, :])
    return q_if, rates_b @ np.swapaxes(axes, -1, -2)


def course(arc: Arc, times: Array) -> Course:
    """Return the motion and its derivatives, by forward differences of eight copies."""
    step = _steps(arc, times)
    shift = step[..., None, :] * np.eye(9, 8, -1)
    copies = Arc(
        arc.epoch,
        np.broadcast_to(arc.q[..., None, :], (*shift.shape[:-1], 4)),
        arc.rate[..., None, :] + shift[..., :3],
        arc.log_inertia[..., None, :] + shift[..., 3:],
    )
    q, rate = along(copies, times)
    if compiled.available():
        return _course_compiled(q, rate, step)
    others = (..., slice(1, None), slice(None), slice(None))
    turn = quaternion.multiply(q[others], quaternion.conjugate(q[..., :1, :, :]))
    turn_by, rate_by = np.zeros((2, *arc.q.shape[:-1], len(times), 3, UNKNOWNS))
    turn_by[..., TURN] = np.eye(3)
    steps = step[..., None, None, :]
    turn_by[..., 3:] = np.moveaxis(turn[..., 1:] / turn[..., :1], -3, -1) / (0.5 * steps)
    rate_by[..., 3:] = np.moveaxis(rate[others] - rate[..., :1, :, :], -3, -1) / steps
    return Course(q[..., 0, :, :], rate[..., 0, :, :], turn_by, rate_by)


def displaced(arc: Arc, error: Array) -> Arc:
    """Return the arc moved by errors (..., 11)."""
    if compiled.available() and arc.q.ndim == 1:
        from debrisest.batch import arc_loops

        errors = np.ascontiguousarray(error.reshape(-1, UNKNOWNS))
        moved = arc_loops.displaced(*arc[1:], errors)
        return Arc(arc.epoch, *(part.reshape(*error.shape[:-1], part.shape[1]) for part in moved))
    q = quaternion.multiply(quaternion.exp(error[..., TURN]), arc.q)
    return Arc(arc.epoch, q, arc.rate + error[..., RATE], arc.log_inertia + error[..., INERTIA])


def moved(arc: Arc, epoch: float) -> Arc:
    """Return the same motion by its state at another epoch, s."""
    q, rate = along(arc, np.array([epoch]))
    return Arc(epoch, quaternion.normalize(q[..., 0, :]), rate[..., 0, :], arc.log_inertia)


def stacked(arcs: Sequence[Arc]) -> Arc:
    """Return arcs of one epoch as copies (arc, ...) of one."""
    return Arc(arcs[0].epoch, *(np.stack(parts) for parts in zip(*(arc[1:] for arc in arcs))))


def chosen(arcs: Arc, which: int | IntArray | list[int]) -> Arc:
    """Return some of the copies."""
    return Arc(arcs.epoch, *(part[which] for part in arcs[1:]))


def joined(*arcs: Arc) -> Arc:
    """Return copies (arc, ...) of one epoch one after the other."""
    return Arc(arcs[0].epoch, *(np.concatenate(parts) for parts in zip(*(arc[1:] for arc in arcs))))


def _along_compiled(arc: Arc, times: Array) -> tuple[Array, Array]:
    from debrisest.batch import arc_loops

    shape = arc.q.shape[:-1]
    q, rate = (np.ascontiguousarray(part.reshape(-1, part.shape[-1])) for part in arc[1:3])
    logs = log_inertia.matrix(arc.log_inertia).reshape(-1, 3, 3)
    q, rate = arc_loops.along(times - arc.epoch, q, rate, logs)
    return q.reshape(*shape, *q.shape[1:]), rate.reshape(*shape, *rate.shape[1:])


def _course_compiled(q: Array, rate: Array, step: Array) -> Course:
    """Return what copies at (..., 9, time, 4) and their rates say of the first one of each."""
    from debrisest.batch import arc_loops

    shape, times = q.shape[:-3], q.shape[-2]
    turn_by, rate_by = arc_loops.derivatives(
        q.reshape(-1, 9, times, 4), rate.reshape(-1, 9, times, 3), step.reshape(-1, 8)
    )
    by = [part.reshape(*shape, *part.shape[1:]) for part in (turn_by, rate_by)]
    return Course(q[..., 0, :, :], rate[..., 0, :, :], *by)


def _steps(arc: Arc, times: Array) -> Array:
    """Steps (..., 8) that turn the end of the arc by about as much each."""
    span = 1.0 + np.abs(times - arc.epoch).max(initial=0.0)
    turned = 1.0 + np.linalg.norm(arc.rate, axis=-1) * span
    result = np.empty((*turned.shape, 8))
    result[..., :3], result[..., 3:] = TURN_OF_STEP / span, TURN_OF_STEP / turned[..., None]
    return result
