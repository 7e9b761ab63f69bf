"""A reconstructed body laid onto a reference, such as a CAD mesh, that has axes of its own.

Candidates are the turns that lay principal axes onto principal axes; each is refined by iterated
closest points, and the nearest one stays. Principal moments alone would hide exchanged axes.
"""

from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array, IntArray
from debrisest.attitude.rotation import nearest_rotation
from debrisest.dynamics.inertia import principal_axes
from debrisest.vision.polyhedron import face_normals, mass_properties

_POINTS = 4000
_ROUNDS = 30
_STILL = 1e-6
"""Of a turn, rad, and of a shift over the body's size: below it the points have settled."""


class Alignment(NamedTuple):
    """What lays points onto the reference: ``rotation @ point + shift``."""

    rotation: Array
    """(3, 3), proper."""
    shift: Array
    """(3,), m."""
    distance: float
    """Root mean square distance of surface points to the reference's, m."""

    def inertia(self, tensor: Array) -> Array:
        """Return a tensor (3, 3) about the centre of mass in the axes of the reference."""
        return np.asarray(self.rotation @ tensor @ self.rotation.T)


def surface_points(vertices: Array, triangles: IntArray, count: int = _POINTS) -> Array:
    """Return points (count, 3) spread evenly, by area, over a mesh: the same ones every time."""
    corners = vertices[triangles]
    area = np.cumsum(np.linalg.norm(face_normals(corners), axis=1))
    steps = (np.arange(count) + 0.5) / count
    face = corners[np.searchsorted(area, steps * area[-1])]
    golden = np.outer(np.arange(1, count + 1), [0.7548776662, 0.5698402910]) % 1.0
    outside = golden.sum(axis=1) > 1.0
    golden[outside] = 1.0 - golden[outside]
    sides = face[:, 1:] - face[:, :1]
    return np.asarray(face[:, 0] + (golden[:, :, None] * sides).sum(axis=1))


def align(
    vertices: Array, triangles: IntArray, reference: Array, reference_triangles: IntArray
) -> Alignment:
    """Return what lays a closed mesh onto a reference mesh; scale is not changed."""
    ours, theirs = (
        mass_properties(vertices, triangles),
        mass_properties(reference, reference_triangles),
    )
    points = surface_points(vertices, triangles) - ours.centre
    goal = surface_points(reference, reference_triangles) - theirs.centre
    tree = scipy.spatial.cKDTree(goal)
    onto = np.linalg.eigh(theirs.inertia)[1]
    back = principal_axes(ours.inertia)[1].T
    starts = [onto @ turn @ np.linalg.eigh(ours.inertia)[1].T for turn in _turns(onto, back)]
    fits = [_closest(points, goal, tree, start) for start in starts]
    best = min(fits, key=lambda fit: fit.distance)
    shift = best.shift + theirs.centre - best.rotation @ ours.centre
    return best._replace(shift=shift)


def _turns(onto: Array, back: Array) -> list[Array]:
    """Return the 24 exchanges of axes with signs that make each start a proper rotation."""
    octahedral = scipy.spatial.transform.Rotation.create_group("O").as_matrix()
    sign = np.sign(np.linalg.det(onto)) * np.sign(np.linalg.det(back))
    return [turn if sign > 0 else turn @ np.diag([1.0, 1.0, -1.0]) for turn in octahedral]


def _closest(
    points: Array, goal: Array, tree: "scipy.spatial.cKDTree", rotation: Array
) -> Alignment:
    """Refine a rotation of centred points by iterated closest points (Besl and McKay 1992)."""
    shift, size = np.zeros(3), np.abs(goal).max()
    for _ in range(_ROUNDS):
        moved = points @ rotation.T + shift
        target = goal[tree.query(moved)[1]]
        centred = target - target.mean(axis=0)
        turn = nearest_rotation(centred.T @ (moved - moved.mean(axis=0)))[0]
        step = target.mean(axis=0) - turn @ moved.mean(axis=0)
        rotation, shift = turn @ rotation, turn @ shift + step
        if np.abs(turn - np.eye(3)).max() < _STILL and np.abs(step).max() < _STILL * size:
            break
    distance = np.asarray(tree.query(points @ rotation.T + shift)[0])
    return Alignment(rotation, shift, float(np.sqrt((distance**2).mean())))
