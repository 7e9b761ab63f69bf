"""Attitude and rate relative to a leader's turning axes over an arc, with sensitivities.

Symbols and errors as in `debrisest.problems.stereo_pose.chart`: rate and attitude errors are in
``l``, attitude errors rotation vectors from the left. Exact at any rate and step, unlike the
integration of `debrisest.dynamics.relative_rotation`; where the arc starts the axes ``l`` are taken
for the inertial ones.
"""

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.relative_orbit import Leader
from debrisest.dynamics.relative_pose import exact_rotation
from debrisest.dynamics.torque_free_sensitivity import parts_of_steps, torque_free_arc

_TURNING = 8
"""Errors that the rotation depends on: rate, attitude, ratios."""


def rotation(
    times: Array, q_lt: Array, rate_l: Array, k: Array, leader: Leader
) -> tuple[Array, Array]:
    """Return attitudes and rates as `rotation_arc`, without sensitivities."""
    if not compiled.available():
        return exact_rotation(times - times[0], q_lt, rate_l, k, leader)
    from debrisest.dynamics.relative_arc_loops import motion_seen

    start = q_lt.copy(), _in_body(q_lt, rate_l, leader)
    return motion_seen(times, start, inertia_ratios.moments(k), _seen_turning(leader))


def rotation_arc(
    times: Array, q_lt: Array, rate_l: Array, k: Array, leader: Leader
) -> tuple[Array, Array, Array]:
    """Return ``q_lt (run, time, 4)``, rates (run, time, 3) and sensitivities (run, time, 6, 8).

    ``q_lt (run, 4)``, ``rate_l (run, 3)``, rad/s, and the ratios ``k (run, 2)`` at the first of
    ``times (time,)``, s, of any order; ``leader`` is the orbit then. Sensitivities are those
    of rate and attitude by rate, attitude and ratios at the start.
    """
    spin = np.array([0.0, 0.0, 1.0]) * leader.rate[:, None]
    to_body = np.swapaxes(quaternion.to_matrix(q_lt), -1, -2)
    total = rate_l + spin[0]
    rate_b = (to_body @ total[..., None])[..., 0]
    half = 0.5 * (leader.anomaly - leader.anomaly[0])
    by_start = np.zeros((len(k), 1, 5, _TURNING))
    by_start[:, 0, :3, :3] = to_body
    by_start[:, 0, :3, 3:6] = to_body @ matrix_of_cross(total)
    by_start[:, 0, 3:, 6:] = np.eye(2)
    if compiled.available():
        from debrisest.dynamics.relative_arc_loops import relative

        orbit = _seen_turning(leader)
        by_ratios = inertia_ratios.acceleration_by_ratios(np.ones((len(k), 3)), k)
        body = inertia_ratios.moments(k), inertia_ratios.slopes(k), by_ratios
        parts = parts_of_steps(times, rate_b)
        return relative(times, (q_lt.copy(), rate_b), body, parts, by_start[:, 0].copy(), orbit)
    arc = torque_free_arc(times, q_lt, rate_b, k)
    zero = np.zeros_like(half)
    q_li = np.stack([np.cos(half), zero, zero, -np.sin(half)], axis=-1)
    q = quaternion.multiply(q_li, arc.q_ib)
    turn, to_l = quaternion.to_matrix(q), quaternion.to_matrix(q_li)
    whole_rate = (turn @ arc.rate_b[..., None])[..., 0]
    sensitivity = np.empty((*q.shape[:2], 6, _TURNING))
    turned = arc.turn_by_start @ by_start
    turned[..., 3:6] += np.eye(3)
    sensitivity[..., 3:, :] = to_l @ turned
    sensitivity[..., :3, :] = (turn @ arc.rate_by_start) @ by_start
    sensitivity[..., :3, :] -= matrix_of_cross(whole_rate) @ sensitivity[..., 3:, :]
    return q, whole_rate - spin, sensitivity


def _in_body(q_lt: Array, rate_l: Array, leader: Leader) -> Array:
    """Whole rates (run, 3) in the body at the start."""
    total = rate_l.copy()
    total[..., 2] += leader.rate[0]
    return quaternion.rotate(quaternion.conjugate(q_lt), total)


def _seen_turning(leader: Leader) -> Array:
    """Cosine and sine of half the turn of the leader since the start, and its rate (time, 3)."""
    half = 0.5 * (leader.anomaly - leader.anomaly[0])
    return np.stack([np.cos(half), np.sin(half), leader.rate], axis=-1)
