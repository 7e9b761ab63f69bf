"""Poses of a body and places of its points from all pixels together (bundle adjustment).

Least squares of the pixels by Gauss and Newton with Huber's weights; the points are eliminated
(Triggs et al. 2000). A turn moves the eye about the body, so that depths come out many times better
than from the pair's base.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy import sparse

from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.vision.stereo_pair import StereoPair

_ITERATIONS = 12
_HUBER = 2.0
"""Times the noise beyond which a residual counts less."""
_STEADY = 1e-9
"""Of the diagonal, added to it."""


class Sightings(NamedTuple):
    """Which point was seen in which epoch, and where."""

    epoch: IntArray
    """(sighting,)."""
    point: IntArray
    """(sighting,)."""
    pixels: Array
    """(sighting, camera, 2)."""


class Bundle(NamedTuple):
    """Where everything is."""

    rotation: Array
    """Body to camera axes (epoch, 3, 3)."""
    translation: Array
    """(epoch, 3), m."""
    points: Array
    """(point, 3), m, axes fixed in the body."""

    def seen(self, sightings: Sightings) -> Array:
        """Return the points of sightings (sighting, 3), m, camera axes."""
        turn, body = self.rotation[sightings.epoch], self.points[sightings.point]
        seen = np.einsum("sij,sj->si", turn, body) + self.translation[sightings.epoch]
        return np.asarray(seen)

    def residuals(self, pair: StereoPair, sightings: Sightings) -> Array:
        """Return pixels less what is expected (sighting, camera, 2)."""
        return np.asarray(sightings.pixels - pair.project(self.seen(sightings)))


def adjusted(pair: StereoPair, start: Bundle, sightings: Sightings) -> Bundle:
    """Return the bundle that fits the pixels best; the pose of the first epoch stays."""
    bundle = start
    for _ in range(_ITERATIONS):
        bundle = _stepped(bundle, *_step(pair, bundle, sightings))
    return bundle


def noise_of(pair: StereoPair, bundle: Bundle, sightings: Sightings) -> float:
    """Return the sigma of a coordinate, px: of the residuals, less the unknowns they were fitted.

    By the median, which a few wrong ones do not change.
    """
    residual = bundle.residuals(pair, sightings)
    unknowns = 6 * (len(np.unique(sightings.epoch)) - 1) + 3 * len(np.unique(sightings.point))
    share = max(1.0 - unknowns / max(residual.size, 1), 0.1)
    return float(1.4826 * np.median(np.abs(residual)) / np.sqrt(share))


def _step(pair: StereoPair, bundle: Bundle, sightings: Sightings) -> tuple[Array, Array]:
    """Return the changes of the poses (epoch, 6), turn and shift, and of the points (point, 3)."""
    epochs, count = len(bundle.rotation), len(bundle.points)
    by_pose, by_point = _derivatives(pair, bundle, sightings)
    residual = bundle.residuals(pair, sightings).reshape(len(by_pose), 4)
    weight = _weights(residual)[..., None]
    point_hold = _summed(by_point, weight * by_point, sightings.point, count)
    pose_hold = _summed(by_pose, weight * by_pose, sightings.epoch, epochs)
    pose_pull = _summed(by_pose, weight * residual[..., None], sightings.epoch, epochs)[..., 0]
    point_pull = _summed(by_point, weight * residual[..., None], sightings.point, count)[..., 0]
    inverse = np.asarray(np.linalg.inv(_steady(point_hold)))
    across = _blocks(
        np.swapaxes(by_pose, -1, -2) @ (weight * by_point),
        sightings.epoch,
        sightings.point,
        (6 * epochs, 3 * count),
    )
    each = np.arange(count)
    inner = _blocks(inverse, each, each, (3 * count, 3 * count))
    every = np.arange(epochs)
    hold = _blocks(_steady(pose_hold), every, every, (6 * epochs, 6 * epochs))
    reduced = (hold - across @ inner @ across.T).toarray()
    pull = pose_pull.ravel() - across @ (inner @ point_pull.ravel())
    turned = np.zeros(6 * epochs)
    turned[6:] = np.linalg.lstsq(reduced[6:, 6:], pull[6:])[0]
    moved = inner @ (point_pull.ravel() - across.T @ turned)
    return turned.reshape(-1, 6), moved.reshape(-1, 3)


def _derivatives(pair: StereoPair, bundle: Bundle, sightings: Sightings) -> tuple[Array, Array]:
    """Return the derivatives of the pixels (sighting, 4, ...) by poses (6) and by points (3)."""
    seen = bundle.seen(sightings)
    by_seen = pair.derivative(seen).reshape(len(seen), 4, 3)
    arm = seen - bundle.translation[sightings.epoch]
    turn = np.cross(np.eye(3), arm[:, None]).swapaxes(-1, -2)
    by_pose = np.concatenate([by_seen @ turn, by_seen], axis=-1)
    return by_pose, by_seen @ bundle.rotation[sightings.epoch]


def _weights(residual: Array) -> Array:
    """Return Huber's weights (sighting, 4), the same for all coordinates of a sighting."""
    scale = 1.4826 * np.median(np.abs(residual)) + 1e-9
    size = np.linalg.norm(residual, axis=-1, keepdims=True) / (2.0 * scale)
    return np.broadcast_to(np.minimum(1.0, _HUBER / np.maximum(size, 1e-9)), residual.shape)


def _summed(left: Array, right: Array, owner: IntArray, count: int) -> Array:
    """Return the sums (count, ...) over the sightings of an owner of ``left^T right``."""
    products = np.swapaxes(left, -1, -2) @ right
    total = np.zeros((count, *products.shape[1:]))
    np.add.at(total, owner, products)
    return total


def _blocks(blocks: Array, row: IntArray, column: IntArray, shape: tuple[int, int]) -> Any:
    """Return a sparse matrix of blocks (n, height, width) at places in units of blocks."""
    _, height, width = blocks.shape
    rows = row[:, None, None] * height + np.arange(height)[:, None]
    columns = column[:, None, None] * width + np.arange(width)
    down, across = (np.broadcast_to(one, blocks.shape).ravel() for one in (rows, columns))
    return sparse.csr_matrix((blocks.ravel(), (down, across)), shape=shape)


def _steady(hold: Array) -> Array:
    trace = np.trace(hold, axis1=-2, axis2=-1)[..., None, None]
    return np.asarray(hold + (_STEADY * trace + (trace == 0.0)) * np.eye(hold.shape[-1]))


def _stepped(bundle: Bundle, turned: Array, moved: Array) -> Bundle:
    turn = quaternion.to_matrix(quaternion.exp(turned[:, :3]))
    return Bundle(turn @ bundle.rotation, bundle.translation + turned[:, 3:], bundle.points + moved)
