"""Solids whose mass properties are known in closed form, as triangle meshes."""

import numpy as np
from scipy.spatial import ConvexHull


def convex(points):
    """Vertices and outward triangles of the hull of points (n, 3)."""
    hull = ConvexHull(points)
    corners = points[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = (normals * hull.equations[:, :3]).sum(1) < 0
    return points, np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices).astype(int)


def box(sides=(2.0, 1.6, 1.2), centre=(0.0, 0.0, 0.0)):
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return convex(np.array(centre) + 0.5 * signs * np.array(sides))


def together(*solids):
    """One mesh of several, vertices after each other."""
    starts = np.cumsum([0, *(len(points) for points, _ in solids[:-1])])
    return (
        np.concatenate([points for points, _ in solids]),
        np.concatenate([faces + start for (_, faces), start in zip(solids, starts)]),
    )


def inverted(solid):
    return solid[0], solid[1][:, ::-1]


def box_inertia(sides, volume):
    a, b, c = np.square(sides)
    return volume / 12 * np.diag([b + c, a + c, a + b])
