"""A body's surface from silhouettes and depth images, fused in voxels.

Signed distances to the surfaces of the depth images are averaged (Curless and Levoy 1996), those of
surfaces that face different sides apart, so that the two sides of a thin panel do not meet
(Splietker and Behnke 2019 keep directions apart for the same reason). What lies outside of the
silhouettes of several images is carved away; the surface is that of marching cubes.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.counted import counted
from debrisest.reconstruction.depth import DepthView
from debrisest.reconstruction.normals import FacingSurface, facing_surface
from debrisest.reconstruction.structure import Structure
from debrisest.vision.libraries import vision_library

_TRUNCATED = 2.0
"""Voxels: distances count no further than this."""
_AT_ONCE = 1 << 18
"""Points that are looked up in a depth image together, so that they stay in the cache."""
_LEAST_COSINE = 0.25
"""Of the normal to the line of sight."""
_LEAST_WEIGHT = 1.0
"""Of a side's surface, about three views, below which it is not known."""
_DOUBTS = 3
"""Views that must see a voxel outside of the silhouette before it is carved away."""

Values = NDArray[np.float32]


class Grid(NamedTuple):
    """Cubes of equal size."""

    origin: Array
    """Middle of the first one (3,), m."""
    voxel: float
    """Their side, m."""
    shape: tuple[int, int, int]

    @property
    def points(self) -> Values:
        """Return their middles (voxel, 3), m."""
        indices = np.indices(self.shape, dtype=np.float32).reshape(3, -1).T
        return np.asarray(self.origin.astype(np.float32) + np.float32(self.voxel) * indices)


def grid_about(points: Array, voxel: float) -> Grid:
    """Return voxels about a cloud (point, 3), a tenth of its extent wider on every side."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.1 * (high - low).max() + 2.0 * voxel
    shape = np.ceil((high - low + 2.0 * margin) / voxel).astype(int) + 1
    return Grid(low - margin, voxel, (int(shape[0]), int(shape[1]), int(shape[2])))


def outside_silhouettes(
    points: Array | Values, masks: BoolArray, matrix: Array, structure: Structure
) -> Values:
    """Return how far points (n, 3) lie outside of the silhouettes (n,), m; negative: inside.

    The value is the third largest over all views of ``masks (time, row, column)``, those of the
    first camera, whose ``matrix (3, 3)`` is given. What an image does not show at all is outside of
    a silhouette that lies wholly within it.
    """
    points = points.astype(np.float32)
    worst = np.full((_DOUBTS, len(points)), -np.inf, dtype=np.float32)
    for frame in structure.registered:
        rotation, shift = structure.rotation[frame], structure.translation[frame]
        seen = points @ rotation.T.astype(np.float32) + shift.astype(np.float32)
        pixel, inside = _pixels(seen, matrix, masks.shape[1:])
        away = _signed_distance(masks[frame])[pixel] * seen[:, 2] / np.float32(matrix[0, 0])
        maybe = _at_the_edge(masks[frame]) & (seen[~inside, 2] > 0)
        away[~inside] = np.where(maybe, -np.inf, np.inf)
        _insert(worst, away)
    return np.asarray(worst[-1])


def _at_the_edge(mask: BoolArray) -> bool:
    """Return whether a silhouette meets the edge of its image, beyond which it may go on."""
    return bool(mask[[0, -1]].any() or mask[:, [0, -1]].any())


def near(grid: Grid, outside: Callable[[Values], Values]) -> Values:
    """Return how far a grid's points lie outside of silhouettes (voxel,), m, exact near and within.

    What is six voxels or more outside by the nearest of every fourth point is not asked again: it
    is at least two voxels outside.
    """
    shape = (np.asarray(grid.shape) + 3) // 4 + 1
    coarse = Grid(grid.origin, 4.0 * grid.voxel, (int(shape[0]), int(shape[1]), int(shape[2])))
    rough = outside(coarse.points).reshape(coarse.shape)
    places = tuple(np.rint(np.arange(n) / 4.0).astype(np.int64) for n in grid.shape)
    found = rough[np.ix_(*places)].ravel()
    asked = np.flatnonzero(found < 6.0 * grid.voxel)
    found[asked] = outside(grid.points[asked])
    return found


def _insert(worst: Values, values: Values) -> None:
    """Keep the largest values in ``worst (place, n)``, in descending order."""
    for place in worst:
        larger = np.maximum(place, values)
        np.minimum(place, values, out=values)
        place[:] = larger


def _signed_distance(mask: BoolArray) -> Values:
    """Return the distance of each pixel to the silhouette's edge, negative inside."""
    cv2 = vision_library("cv2")
    outside, inside = (
        cv2.distanceTransform(side.astype(np.uint8), cv2.DIST_L2, 5) for side in (~mask, mask)
    )
    return np.asarray(outside - inside + np.where(mask, 0.5, -0.5), dtype=np.float32)


def _pixels(
    seen: Values, matrix: Array, shape: tuple[int, ...]
) -> tuple[tuple[IntArray, IntArray], BoolArray]:
    """Return the row and column of points before a camera, and which of them lie in the image."""
    ahead = np.maximum(seen[:, 2], np.float32(1e-6))
    u = np.rint(seen[:, 0] / ahead * matrix[0, 0] + matrix[0, 2])
    v = np.rint(seen[:, 1] / ahead * matrix[1, 1] + matrix[1, 2])
    inside = (seen[:, 2] > 0) & (u >= 0) & (v >= 0) & (u < shape[1]) & (v < shape[0])
    row = np.where(inside, v, 0).astype(np.int64)
    return (row, np.where(inside, u, 0).astype(np.int64)), np.asarray(inside)


def distance_to_surfaces(points: Values, views: Sequence[DepthView], reach: float) -> Values:
    """Return how far points (n, 3) lie before the surfaces (n,), in units of ``reach``, m.

    Negative: within the body; -1 where no surface is near. Surfaces that face the same of six
    sides are averaged, with the cosine of the line of sight as weight; what lies before the
    surface of any side is outside. An average over all sides would fill, or lose, what is thinner
    than ``reach``: there each side of a panel counts as the depth of the other one.
    """
    total, weight = np.zeros((2, 2 * 3, len(points)), dtype=np.float32)
    for found in counted(views, "depth images fused"):
        surface = facing_surface(found)
        for begin in range(0, len(points), _AT_ONCE):
            some = slice(begin, begin + _AT_ONCE)
            which, ahead, sides = _before(points[some], found, surface, reach)
            total[:, begin + which] += sides * ahead
            weight[:, begin + which] += sides
    mean = np.divide(total, np.maximum(weight, np.float32(1e-6)), out=total)
    mean[weight <= _LEAST_WEIGHT] = -1.0
    return np.asarray(mean.max(axis=0))


def _before(
    points: Values, found: DepthView, surface: FacingSurface, reach: float
) -> tuple[IntArray, Values, Values]:
    """Return how far points lie before what a depth image shows, and as the surface of which side.

    Which points (n,) these are, the distance (n,), at most one ``reach``, and weights (side, n).
    Points further behind are left out.
    """
    seen = found.view.seen(points.astype(np.float64)).astype(np.float32)
    (row, column), inside = _pixels(seen, found.view.matrix, found.depth.shape)
    cosine = surface.cosine[row, column]
    ahead = (surface.points[row, column, 2] - seen[:, 2]) * cosine / reach
    which = np.flatnonzero(inside & (cosine > _LEAST_COSINE) & (ahead > -1.0))
    normals = surface.normals[row[which], column[which]].T
    facing = np.concatenate([normals, -normals])
    sides = np.where(facing > 0.5, facing**2, 0.0) * cosine[which]
    return which, np.minimum(ahead[which], 1.0).astype(np.float32), sides.astype(np.float32)


def fused_mesh(grid: Grid, outside: Values, views: Sequence[DepthView]) -> tuple[Array, IntArray]:
    """Return vertices and triangles, counterclockwise from outside, of the fused surface.

    ``outside`` is what `outside_silhouettes` tells of the grid's points.
    Pieces of less than a hundredth of the largest, and hollows, are left out.
    """
    measure = vision_library("skimage.measure")
    reach = _TRUNCATED * grid.voxel
    field = np.clip(outside / reach, -1.0, 1.0)
    left = np.flatnonzero(field < 1.0)
    field[left] = np.maximum(field[left], distance_to_surfaces(grid.points[left], views, reach))
    field = field.reshape(grid.shape)
    solid = _large(field < 0.0)
    field = np.where(solid, np.minimum(field, -1e-3), np.maximum(field, 1e-3))
    field = np.pad(field, 1, constant_values=1.0)
    vertices, triangles, _, _ = measure.marching_cubes(field.astype(np.float64), 0.0)
    points = grid.origin + grid.voxel * (vertices.astype(np.float64) - 1.0)
    return points, triangles.astype(np.int64)


def _large(inside: BoolArray) -> BoolArray:
    label, count = scipy.ndimage.label(inside)
    if not count:
        raise ValueError("silhouettes and depth leave nothing of the body")
    sizes = np.bincount(label.ravel())
    sizes[0] = 0
    kept = sizes[label] > 0.01 * sizes.max()
    return np.asarray(scipy.ndimage.binary_fill_holes(kept & (label > 0)))
