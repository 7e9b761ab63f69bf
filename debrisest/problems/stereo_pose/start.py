"""A point to start from, in closed form, out of the first frame of the two cameras."""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import cross, matrix_of_cross
from debrisest.dynamics import inertia_ratios
from debrisest.filters import weights
from debrisest.filters.linear_algebra import solve
from debrisest.problems.stereo_pose.model import (
    POINTS,
    POSITION,
    RATE,
    VELOCITY,
    K,
    Q,
    StereoGeometry,
    points_in_view,
)
from debrisest.sensors import stereo

_PASSES = 10
_PRIOR_SHARE = 0.01
"""Part of the prior's information on the rates that the fit of the flow is given."""


def first_guess(
    known: StereoGeometry, prior: Array, prior_sigma: Array, shown: Array, sigma: Array, epoch: int
) -> Array:
    """State ``(run, n)`` at epoch 0 that agrees with what ``epoch`` shows, ``(run, m)``.

    Only a point to linearise at: the prior ``(run, n)`` keeps its place in the cost. Points come
    from both cameras, velocity and rate from the flow by least squares, the centre of mass is the
    most likely one under the prior (``prior_sigma (n_e,)``). What was not seen (NaN) is the
    prior's. ``sigma (m,)`` is the measurements' noise.
    """
    frame, noise = _frame(known, shown), _frame(known, sigma[None])
    time = known.steps[:epoch].sum()
    guess, velocity = points_in_view(prior, known.points)
    cloud = _points(known, frame, guess + time * velocity)
    centre_velocity, rate = _rates(known, prior, prior_sigma, cloud, frame, noise)
    arms = cloud - cloud.mean(-2, keepdims=True)
    moving = centre_velocity[:, None] + cross(rate[:, None], arms)
    cloud = cloud - time * moving
    turn = quaternion.to_matrix(prior[:, Q])
    prior_arms = prior[:, POINTS].reshape(cloud.shape) @ np.swapaxes(turn, -1, -2)
    weight_r = prior_sigma[POSITION] ** -2.0
    weight_p = prior_sigma[14:17] ** -2.0
    position = (weight_r * prior[:, POSITION] + weight_p * (cloud - prior_arms).sum(-2)) / (
        weight_r + known.points * weight_p
    )
    start = prior.copy()
    start[:, POSITION], start[:, RATE] = position, rate
    start[:, VELOCITY] = centre_velocity - cross(rate, cloud.mean(-2) - position)
    start[:, POINTS] = ((cloud - position[:, None]) @ turn).reshape(len(prior), -1)
    start[:, K] = inertia_ratios.feasible(prior[:, K])
    return start


def _frame(known: StereoGeometry, shown: Array) -> Array:
    """All nine rows of every point ``(run, N, 9)``; NaN where a row is not measured."""
    frame = np.full((len(shown), known.points, stereo.ROWS), np.nan)
    count = known.points * len(known.rows)
    frame[..., known.rows] = shown[:, :count].reshape(len(shown), known.points, -1)
    return frame


def _points(known: StereoGeometry, frame: Array, guess: Array) -> Array:
    """Points ``(run, N, 3)`` in the leader's axes, or their guess."""
    y = stereo.depth(frame, known.baseline)
    point = np.stack([frame[..., 0] * y, y, frame[..., 1] * y], axis=-1)
    sound = np.isfinite(point).all(-1) & (y > 0.0)
    if known.to_camera is not None:
        point = point @ known.to_camera
    return np.where(sound[..., None], point, guess)


def _rates(
    known: StereoGeometry,
    prior: Array,
    prior_sigma: Array,
    cloud: Array,
    frame: Array,
    noise: Array,
) -> tuple[Array, Array]:
    """Velocity of the points' mean and rate, ``(run, 3)`` each, from the flow of both cameras.

    Each row of the flow says ``V_across - slope V_y = flow y``, linear in both unknowns.
    """
    slopes, flow = frame[..., stereo.PIXELS], frame[..., stereo.FLOW]
    camera = np.eye(3) if known.to_camera is None else known.to_camera
    y = cloud @ camera[1][:, None]
    direction = camera[[0, 2, 0, 2]] - slopes[..., None] * camera[1]
    arms = cloud - cloud.mean(-2, keepdims=True)
    by_rate = -direction @ matrix_of_cross(arms)
    weight = 1.0 / (noise[..., stereo.FLOW] * np.abs(y))
    matrix = np.concatenate([direction, by_rate], axis=-1) * weight[..., None]
    right = flow * y * weight
    seen = np.isfinite(right) & np.isfinite(matrix).all(-1)
    matrix = np.where(seen[..., None], matrix, 0.0).reshape(len(prior), -1, 6)
    right = np.where(seen, right, 0.0).reshape(len(prior), -1, 1)
    at = prior[:, VELOCITY.start : RATE.stop]
    information = _PRIOR_SHARE * prior_sigma[VELOCITY.start : RATE.stop] ** -2.0
    both = at[..., None]
    for _ in range(_PASSES):
        weighted = weights.cauchy(right - matrix @ both) ** 2
        transposed = np.swapaxes(matrix * weighted, -1, -2)
        both = solve(
            transposed @ matrix + np.diag(information),
            transposed @ right + (information * at)[..., None],
        )
    return both[:, :3, 0], both[:, 3:, 0]
