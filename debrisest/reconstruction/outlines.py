"""Outlines of a body in images by the cloud of its points, where silhouettes do not tell it.

In each image the convex hull of what hangs together in the cloud: hollows count as the body's.
"""

import numpy as np
import scipy

from debrisest.arrays import Array, BoolArray
from debrisest.reconstruction.structure import Structure
from debrisest.vision.libraries import vision_library

_LEAST_IMAGES, _FEWEST = 3, 20
_NEIGHBOURS = 3
_APART = 2.0
"""Of the usual distance to the last of the neighbours; points farther apart hang not together."""


def main_part(structure: Structure) -> BoolArray:
    """Return which points (point,) belong to the largest part that hangs together.

    Points that fewer than three images see do not count. Raises ValueError where few are left.
    """
    kept: BoolArray = np.asarray(structure.seen.sum(axis=0) >= _LEAST_IMAGES)
    if kept.sum() < _FEWEST:
        raise ValueError(f"the cloud has {kept.sum()} points that three images see: too few")
    kept[kept] = _hanging_together(structure.points[kept])
    return kept


def _hanging_together(points: Array) -> BoolArray:
    tree = scipy.spatial.cKDTree(points)
    distance, _ = tree.query(points, k=[_NEIGHBOURS + 1])
    usual = np.median(distance)
    pairs = tree.query_pairs(_APART * float(usual), output_type="ndarray")
    shape = (len(points), len(points))
    graph = scipy.sparse.coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=shape)
    label = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
    return np.asarray(label == np.bincount(label).argmax())


def outlines(structure: Structure, matrix: Array, shape: tuple[int, int]) -> BoolArray:
    """Return where the body is in images (time, row, column) of a camera, ``matrix (3, 3)``.

    Nowhere in images that found no place, or in which no point is ahead.
    """
    cv2 = vision_library("cv2")
    masks = np.zeros((len(structure.rotation), *shape), dtype=np.uint8)
    for frame in structure.registered:
        seen = structure.points @ structure.rotation[frame].T + structure.translation[frame]
        ahead = seen[seen[:, 2] > 0]
        pixels = ahead @ matrix.T / ahead[:, 2:]
        if len(pixels) > 2:
            hull = cv2.convexHull(np.rint(pixels[:, :2]).astype(np.int32))
            cv2.fillConvexPoly(masks[frame], hull, 1)
    return masks > 0
