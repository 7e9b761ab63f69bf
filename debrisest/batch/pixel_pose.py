"""Pose of a known body at each epoch from the pixels of one or more calibrated cameras.

Gauss and Newton, all epochs and 24 starts at once: with an attitude given, the position follows
linearly from the lines of sight, so that nothing but the attitude has to be searched. What comes
out are attitudes with covariances, which `estimate_from_attitudes` takes.
"""

from itertools import permutations, product
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import matrix_of_cross

_ROUNDS = ((8, 4), (2, 6))  # starts kept of 24, after so many iterations
_ITERATIONS = 12  # of the best
_FEWEST_POINTS = 3
_NEAREST = 1e-3  # of the body's size, the least distance before a camera
_LARGEST_STEP = 0.5  # rad


class Camera(NamedTuple):
    """A pinhole camera, whose axes are x right, y down, z ahead."""

    focal: Array
    """(2,), px."""
    centre: Array
    """(2,), px."""
    position: Array
    """Of the camera in the axes ``c`` that all cameras of the rig refer to (3,), m."""
    axes: Array
    """Columns are the camera's axes in ``c`` (3, 3)."""


class Poses(NamedTuple):
    """Poses of the body in the axes ``c`` of the rig; NaN where the pixels do not tell."""

    q: Array
    """``q_cf (time, 4)``."""
    position: Array
    """Origin of the body's points (time, 3), m."""
    covariance: Array
    """Of the turn in ``c`` and of the position (time, 6, 6)."""
    chi2: Array
    """(time,)."""
    dof: Array
    """(time,)."""


def poses_from_pixels(
    cameras: list[Camera], pixels: Array, sigma: Array | float, model: Array
) -> Poses:
    """Return poses from ``pixels (time, camera, feature, 2)``, NaN where not seen.

    ``sigma``, px, broadcasts to the pixels; ``model (feature, 3)``, m. At least three points, and
    six numbers, are needed; a pose of three points in one camera may be the wrong of two.
    """
    seen = np.asarray(np.isfinite(pixels).all(axis=-1))
    points = seen.any(axis=1).sum(axis=-1)
    enough = (points >= _FEWEST_POINTS) & (2 * seen.sum(axis=(1, 2)) >= 6)
    weight = np.where(seen[..., None], 1.0 / np.broadcast_to(sigma, pixels.shape) ** 2, 0.0)
    shown = np.where(seen[..., None], pixels, 0.0)
    shapes = (4,), (3,), (6, 6), (), ()
    result = Poses(*(np.full((len(pixels), *shape), np.nan) for shape in shapes))
    if not enough.any():
        return result
    found = _poses(_Problem(cameras, shown[enough], weight[enough], model))
    for whole, part in zip(result, found):
        whole[enough] = part
    return result


def _poses(problem: "_Problem") -> Poses:
    """Return poses of epochs with enough points; NaN where the pixels do not tell them."""
    q, position = _iterated(problem, *_best_start(problem), _ITERATIONS)
    residual, derivative, _ = problem.linearized(q, position)
    hold, _ = _normal(residual, derivative, problem.weight)
    chi2 = np.sum(problem.weight * residual**2, axis=(1, 2, 3))
    told = (np.linalg.eigvalsh(_scaled(hold))[:, 0] > 1e-9) & np.isfinite(chi2)
    covariance = np.full(hold.shape, np.nan)
    covariance[told] = np.linalg.inv(hold[told])
    dof = np.sum(problem.weight > 0.0, axis=(1, 2, 3)) - 6.0
    blank = np.where(told, 0.0, np.nan)
    return Poses(q + blank[:, None], position + blank[:, None], covariance, chi2, dof)


class _Problem(NamedTuple):
    """Pixels with weights; the leading axes of poses are (..., time)."""

    cameras: list[Camera]
    pixels: Array
    weight: Array
    model: Array

    def linearized(self, q: Array, position: Array) -> tuple[Array, Array, BoolArray]:
        """Return residuals (..., time, camera, feature, 2), their derivatives by the pose, (6),
        and whether all points that are seen lie before the cameras."""
        turned = self.model @ np.swapaxes(quaternion.to_matrix(q), -1, -2)
        placed = turned + position[..., None, :]
        by_turn = np.concatenate(
            [-matrix_of_cross(turned), np.broadcast_to(np.eye(3), (*turned.shape, 3))], axis=-1
        )
        shortest = _NEAREST * np.ptp(self.model, axis=0).max()
        residuals, derivatives, ahead = [], [], []
        for number, camera in enumerate(self.cameras):
            local = (placed - camera.position) @ camera.axes
            depth = np.maximum(local[..., 2:], shortest)
            plane = local[..., :2] / depth
            shown = camera.centre + camera.focal * plane
            by_point = np.zeros((*local.shape[:-1], 2, 3))
            by_point[..., 0, 0] = by_point[..., 1, 1] = 1.0
            by_point[..., 2] = -plane
            by_point *= camera.focal[:, None] / depth[..., None]
            residuals.append(self.pixels[:, number] - shown)
            derivatives.append(by_point @ camera.axes.T @ by_turn)
            weighed = self.weight[:, number, :, 0] > 0.0
            ahead.append(np.all((local[..., 2] > shortest) | ~weighed, axis=-1))
        return np.stack(residuals, -3), np.stack(derivatives, -4), np.all(ahead, axis=0)

    def position(self, q: Array) -> Array:
        """Return the position (..., time, 3) nearest to all lines of sight."""
        turned = self.model @ np.swapaxes(quaternion.to_matrix(q), -1, -2)
        hold: Array | float = 1e-12 * np.eye(3)
        pull: Array | float = 0.0
        for number, camera in enumerate(self.cameras):
            plane = (self.pixels[:, number] - camera.centre) / camera.focal
            sight = np.concatenate([plane, np.ones((*plane.shape[:-1], 1))], axis=-1)
            sight = sight @ camera.axes.T
            sight /= np.linalg.norm(sight, axis=-1, keepdims=True)
            across = np.eye(3) - sight[..., :, None] * sight[..., None, :]
            across = across * (self.weight[:, number, :, 0] > 0.0)[..., None, None]
            offset = camera.position - turned
            hold = hold + across.sum(axis=-3)
            pull = pull + np.sum((across @ offset[..., None])[..., 0], axis=-2)
        return np.asarray(np.linalg.solve(hold, np.asarray(pull)[..., None])[..., 0])


def _best_start(problem: _Problem) -> tuple[Array, Array]:
    """Return the best pose (time, ...) after some iterations from 24 attitudes."""
    starts = _cube_rotations()
    q = np.broadcast_to(starts[:, None], (len(starts), len(problem.pixels), 4))
    position = problem.position(q)
    for kept, iterations in _ROUNDS:
        q, position = _iterated(problem, q, position, iterations)
        residual, _, ahead = problem.linearized(q, position)
        chi2 = np.sum(problem.weight * residual**2, axis=(-3, -2, -1))
        order = np.argsort(np.where(ahead & np.isfinite(chi2), chi2, np.inf), axis=0)
        best = order[:kept, :, None]
        q, position = (np.take_along_axis(part, best, axis=0) for part in (q, position))
    return q[0], position[0]


def _iterated(problem: _Problem, q: Array, position: Array, count: int) -> tuple[Array, Array]:
    """Return poses after damped steps; a step that gains nothing is damped more."""
    damping = np.full(q.shape[:-1], 1e-3)
    residual, derivative, _ = problem.linearized(q, position)
    cost = np.sum(problem.weight * residual**2, axis=(-3, -2, -1))
    for _ in range(count):
        hold, pull = _normal(residual, derivative, problem.weight)
        diagonal = np.diagonal(hold, 0, -2, -1)
        damped = hold + (damping[..., None] * diagonal + 1e-12)[..., None] * np.eye(6)
        step = np.asarray(np.linalg.solve(damped, pull[..., None])[..., 0], dtype=np.float64)
        length = np.linalg.norm(step[..., :3], axis=-1, keepdims=True)
        step *= np.minimum(1.0, _LARGEST_STEP / np.maximum(length, 1e-12))
        q_new = quaternion.multiply(quaternion.exp(step[..., :3]), q)
        position_new = position + step[..., 3:]
        residual_new, derivative_new, _ = problem.linearized(q_new, position_new)
        cost_new = np.sum(problem.weight * residual_new**2, axis=(-3, -2, -1))
        better = cost_new < cost
        q, position = (
            np.where(better[..., None], new, old)
            for new, old in ((q_new, q), (position_new, position))
        )
        wide = better[..., None, None, None]
        residual = np.where(wide, residual_new, residual)
        derivative = np.where(wide[..., None], derivative_new, derivative)
        cost = np.where(better, cost_new, cost)
        damping = np.where(better, 0.2 * damping, 10.0 * damping)
    return q, position


def _normal(residual: Array, derivative: Array, weight: Array) -> tuple[Array, Array]:
    """Return information (..., time, 6, 6) and pull (..., time, 6)."""
    shape = derivative.shape[:-4]
    rows = derivative.reshape(*shape, -1, 6)
    weighed = np.swapaxes(rows * weight.reshape(len(weight), -1, 1), -1, -2)
    return weighed @ rows, (weighed @ residual.reshape(*shape, -1, 1))[..., 0]


def _scaled(hold: Array) -> Array:
    scale = np.maximum(np.diagonal(hold, 0, -2, -1), 1e-300) ** -0.5
    return np.asarray(scale[..., :, None] * hold * scale[..., None, :])


def _cube_rotations() -> Array:
    """The 24 rotations of a cube as quaternions (24, 4)."""
    orders = np.eye(3)[list(permutations(range(3)))]
    signs = np.array(list(product((1.0, -1.0), repeat=3)))
    turns = (orders[:, None] * signs[..., None]).reshape(-1, 3, 3)
    return quaternion.from_matrix(turns[np.linalg.det(turns) > 0.0])
