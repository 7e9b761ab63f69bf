"""Surface, mass properties and error bars of a body from images whose places are known.

Which surface is chosen by the data: a body that fills most of its convex hull gets the screened
Poisson surface of its dense cloud, any other one, such as a thin panel, silhouettes fused with
depth in voxels.

Error bars (1 sigma) are the root of the sum of squares of three: that of the scale (three times it
for the volume, five times for the inertia); what a coarser resolution changes; and coverage, where
surface that no image shows is taken to be off by a third of its distance from the centre, which is
its share for the volume and 5/3 of it for the inertia.
"""

from typing import Literal, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull, QhullError, cKDTree

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.reconstruction import fusion
from debrisest.reconstruction.closed_mesh import ClosedMesh, closed_mesh
from debrisest.reconstruction.dense_cloud import OrientedCloud, dense_cloud
from debrisest.reconstruction.depth import DepthView, depth_views
from debrisest.reconstruction.poisson import poisson_mesh
from debrisest.reconstruction.silhouettes import Frames
from debrisest.reconstruction.structure import Rig, Structure
from debrisest.reconstruction.winding import pieces_of
from debrisest.vision.polyhedron import MassProperties, mass_properties

Method = Literal["poisson", "fusion"]
COMPACT = 0.75
"""Share of the convex hull that a compact body fills."""
LEAST_COVERAGE = 0.8
"""Of the surface, below which no number is given."""
_CELLS = (80, 120)
"""Cells along the body, of the coarse and of the fine surface."""
_DEPTH = (6, 7)
_NEAR = 0.025
"""Of the body's extent: how near a point of the cloud makes the surface a seen one."""
_NEXT_PX = 2.0
_AGREED = 0.8
"""Share of the structure's points that silhouettes must hold."""
_HULL_CELLS = 60


class Body(NamedTuple):
    """What images tell of a body of density one; lengths in those of the structure."""

    mesh: ClosedMesh
    properties: MassProperties
    sigma: Array
    """1-sigma (10,) of volume, centre and inertia xx, yy, zz, xy, xz, yz."""
    method: Method
    fill: float
    """Share of the cloud's hull that the fused surface fills, by which the method was chosen."""
    cell: float
    """Side of the finer resolution's cells."""
    coverage: float
    """Share of the surface that the images show."""
    seen: BoolArray
    """Which triangles they show (triangle,)."""
    hull_volume: float
    """Of the convex hull, for a cross-check: the volume is no larger."""
    silhouette_volume: float
    """Of what all silhouettes share: the volume is no larger, but for their errors."""


TENSOR = ((0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2))
"""Rows and columns of the components xx, yy, zz, xy, xz, yz."""


def packed(properties: MassProperties) -> Array:
    """Return volume, centre and inertia xx, yy, zz, xy, xz, yz as one vector (10,)."""
    return np.array([properties.volume, *properties.centre, *properties.inertia[TENSOR]])


def reconstructed_body(
    frames: Frames,
    masks: BoolArray,
    rig: Rig,
    structure: Structure,
    method: Method | None = None,
    known_length: tuple[float, float] | None = None,
) -> Body:
    """Return the body in images (time, camera, row, column) without distortion.

    ``known_length`` is the longest distance between two points of the body, and its 1-sigma: it
    replaces the scale of the structure. Raises ValueError where no closed surface comes out.
    """
    outer = _Outer(masks[:, 0], rig.matrix[0], structure)
    held = outer.holds(structure.points)
    if held.mean() < _AGREED:
        raise ValueError(
            f"the structure does not agree with the silhouettes, which hold {held.mean():.0%} of "
            "its points: images were placed wrongly; take more of them, or larger ones"
        )
    structure = structure.of(held)
    outer = outer._replace(structure=structure)
    views = depth_views(frames, masks, rig, structure)
    extent = float(np.ptp(structure.points, axis=0).max())
    cloud = _cloud(views, outer, extent / _CELLS[0])
    rough = _fused(views, outer, extent / _CELLS[0])
    hull = _hull_volume(cloud.points)
    fill = mass_properties(rough.vertices, rough.triangles).volume / hull
    chosen = method or ("poisson" if fill > COMPACT else "fusion")
    if chosen == "poisson":
        fine = _cloud(views, outer, extent / _CELLS[1])
        try:
            coarse, mesh = (_poisson(*each) for each in zip((cloud, fine), _DEPTH))
        except ValueError:
            chosen = "fusion"
    if chosen == "fusion":
        coarse, mesh = rough, _fused(views, outer, extent / _CELLS[1])
    cell = extent / _CELLS[1]
    seen = _seen(mesh, cloud, _NEAR * extent)
    silhouettes = outer.volume(extent / _HULL_CELLS)
    factor, scale_sigma = _scale(mesh, structure, known_length, cell)
    found, rough_found = (
        mass_properties(each.vertices * factor, each.triangles) for each in (mesh, coarse)
    )
    coverage = _share(mesh, seen)
    sigma = _sigma(found, rough_found, scale_sigma, 1.0 - coverage)
    scaled = mesh._replace(vertices=mesh.vertices * factor)
    return Body(
        *(scaled, found, sigma, chosen, fill, cell * factor, coverage, seen),
        *(hull * factor**3, silhouettes * factor**3),
    )


class _Outer(NamedTuple):
    """Silhouettes of the first camera (time, row, column), its matrix and its places."""

    masks: BoolArray
    matrix: Array
    structure: Structure

    def outside(self, points: Array | fusion.Values) -> fusion.Values:
        return fusion.outside_silhouettes(points, *self)

    def holds(self, points: Array) -> BoolArray:
        """Return which points (n, 3) lie in the silhouettes, or next to them."""
        away = self.structure.translation[self.structure.registered]
        pixel = np.median(np.linalg.norm(away, axis=1)) / self.matrix[0, 0]
        return np.asarray(self.outside(points) < _NEXT_PX * pixel)

    def volume(self, voxel: float) -> float:
        """Return the volume of what all silhouettes share."""
        grid = fusion.grid_about(self.structure.points, voxel)
        return float((self.outside(grid.points) < 0.0).sum() * voxel**3)


def _cloud(views: list[DepthView], outer: _Outer, cell: float) -> OrientedCloud:
    """Return the dense cloud, as far as it lies in the silhouettes."""
    found = dense_cloud(views, cell)
    kept = outer.holds(found.points)
    return OrientedCloud(found.points[kept], found.normals[kept])


def _poisson(cloud: OrientedCloud, depth: int) -> ClosedMesh:
    return closed_mesh(*_main_piece(*poisson_mesh(cloud, depth)))


def _main_piece(vertices: Array, triangles: IntArray) -> tuple[Array, IntArray]:
    """Return the connected piece with the most triangles: bubbles about it are none of the body."""
    piece = pieces_of(triangles)
    return vertices, triangles[piece == np.bincount(piece).argmax()]


def _fused(views: list[DepthView], outer: _Outer, voxel: float) -> ClosedMesh:
    grid = fusion.grid_about(outer.structure.points, voxel)
    return closed_mesh(*fusion.fused_mesh(grid, outer.outside(grid.points), views))


def _hull_volume(points: Array) -> float:
    try:
        return float(ConvexHull(points).volume)
    except QhullError:
        raise ValueError("the points of the surface lie in a plane") from None


def _longest(vertices: Array) -> float:
    corners = vertices[ConvexHull(vertices).vertices]
    return float(max(np.linalg.norm(corners - corner, axis=1).max() for corner in corners))


def _seen(mesh: ClosedMesh, cloud: OrientedCloud, reach: float) -> BoolArray:
    """Return which triangles have points of the cloud near that face the same way."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    near, index = cKDTree(cloud.points).query(corners.mean(axis=1), k=8)
    alike = np.einsum("ti,tki->tk", normals, cloud.normals[index])
    alike /= np.maximum(np.linalg.norm(normals, axis=1), 1e-30)[:, None]
    return np.asarray(((near < reach) & (alike > 0.3)).any(axis=1))


def _share(mesh: ClosedMesh, seen: BoolArray) -> float:
    """Return the share of the area."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1)
    return float(area[seen].sum() / area.sum())


def _sigma(
    found: MassProperties, coarse: MassProperties, scale_sigma: float, unseen: float
) -> Array:
    """Return the 1-sigma (10,) of volume, centre and inertia."""
    size = np.sqrt(np.trace(found.inertia) / (2.0 * found.volume))
    moments = np.diag(found.inertia)
    level = np.sqrt(moments[list(TENSOR[0])] * moments[list(TENSOR[1])])
    scale = np.array([found.volume, *3 * [size], *level])
    changed = np.abs(packed(found) - packed(coarse))
    powers = np.array([3.0, *3 * [0.0], *3 * [5.0], *3 * [0.0]])
    shares = np.array([1.0, *3 * [1.0 / 3.0], *6 * [5.0 / 3.0]])
    known = scale_sigma if np.isfinite(scale_sigma) else 0.0
    parts = (changed, scale * powers * known, scale * shares * unseen)
    return np.asarray(np.linalg.norm(parts, axis=0))


def _scale(
    mesh: ClosedMesh, structure: Structure, known_length: tuple[float, float] | None, cell: float
) -> tuple[float, float]:
    """Return the factor that lengths take, and the relative 1-sigma of the scale."""
    if known_length is None:
        return 1.0, structure.scale_sigma
    length = _longest(mesh.vertices)
    relative = float(np.hypot(known_length[1] / known_length[0], cell / length))
    return known_length[0] / length, relative
