"""Straight lines and a convex target: where one leaves it, and where it hides a point."""

import numpy as np

from debrisest.arrays import Array, BoolArray

_GRAZING = 1e-9
"""Part of a line of sight that may lie inside the target."""
FEWEST_POINTS = 4
"""Points that span a body: fewer have no shape that a camera could tell."""


def box_faces(half_sides: Array) -> tuple[Array, Array]:
    """Outward normals ``(6, 3)`` and distances ``(6,)`` of the faces of a box about the origin."""
    normals = np.concatenate([np.eye(3), -np.eye(3)])
    return normals, np.concatenate([half_sides, half_sides])


def hull_faces(points: Array) -> tuple[Array, Array]:
    """Outward normals ``(face, 3)`` and distances ``(face,)`` of the hull of points ``(n, 3)``.

    The origin must lie inside, since it is where the lines start.
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        equations = ConvexHull(points).equations
    except QhullError as error:
        raise ValueError("the points lie in a plane; give half_sides_m") from error
    if not np.all(equations[:, 3] < 0.0):
        raise ValueError(
            "the centre of mass lies outside the hull of the points, so that a range to its "
            "surface has no meaning; give the half sides of the body"
        )
    return equations[:, :3], -equations[:, 3]


def depth_along(direction: Array, faces: tuple[Array, Array]) -> Array:
    """Distance ``(...)``, m, from the centre of mass to the surface along ``direction (..., 3)``.

    Directions are unit vectors in body axes.
    """
    normals, distances = faces
    with np.errstate(divide="ignore"):
        facing = direction @ normals.T
        lengths = np.where(facing > 0.0, distances / facing, np.inf)
    return np.asarray(lengths.min(axis=-1))


def hidden_by_box(points: Array, observer: Array, half_sides: Array) -> BoolArray:
    """Whether a box about the origin hides points ``(..., n, 3)`` from observers ``(..., 3)``.

    All in body axes, m. A point on the box's surface is hidden where all faces that it belongs to
    turn their backs on the observer.
    """
    sight = observer[..., None, :] - points
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([(-half_sides - points) / sight, (half_sides - points) / sight])
    enter = np.nan_to_num(ends.min(0), nan=-np.inf).max(-1)
    leave = np.nan_to_num(ends.max(0), nan=np.inf).min(-1)
    return np.asarray(leave > np.maximum(enter, 0.0) + _GRAZING)
