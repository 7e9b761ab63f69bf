"""One surface around solids that overlap, by Manifold."""

from functools import reduce
from typing import Any

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.vision.libraries import vision_library


def union(vertices: Array, pieces: list[IntArray]) -> tuple[Array, IntArray]:
    """Return vertices and triangles of the union of closed pieces, less the cavities among them.

    A piece that is wound inwards is a cavity. Raises UserError where Manifold is not installed and
    ValueError where it does not take a piece.
    """
    manifold = vision_library("manifold3d")
    solids: list[Any] = []
    cavities: list[Any] = []
    for triangles in pieces:
        hollow = np.linalg.det(vertices[triangles] - vertices[triangles[0, 0]]).sum() < 0.0
        used, index = np.unique(triangles[:, ::-1] if hollow else triangles, return_inverse=True)
        mesh = manifold.Mesh64(vertices[used], index.reshape(-1, 3).astype(np.uint64))
        (cavities if hollow else solids).append(manifold.Manifold(mesh))
    whole = reduce(lambda a, b: a + b, solids)
    for cavity in cavities:
        whole -= cavity
    if whole.status() != manifold.Error.NoError:
        raise ValueError("solids overlap in a way that cannot be mended; unite them first")
    result = whole.to_mesh64()
    points = np.asarray(result.vert_properties, dtype=np.float64)[:, :3]
    return points, np.asarray(result.tri_verts, dtype=np.int64)
