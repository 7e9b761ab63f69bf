"""Surface, mass properties and error bars of a body from images whose places are known.

The surface is that of silhouettes fused with depth in voxels, which closes whatever is seen and
keeps thin panels. The screened Poisson surface of the dense cloud can be chosen instead: it was
as near to compact bodies and lost panels.
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.reconstruction import fusion
from debrisest.reconstruction.closed_mesh import ClosedMesh, closed_mesh
from debrisest.reconstruction.coverage import share_of_area, triangles_seen
from debrisest.reconstruction.dense_cloud import OrientedCloud, dense_cloud
from debrisest.reconstruction.depth import DepthView, depth_views
from debrisest.reconstruction.error_bars import Doubts, depth_sigma, error_bars
from debrisest.reconstruction.outer import Outer
from debrisest.reconstruction.outline_choice import Outline, outlined
from debrisest.reconstruction.poisson import poisson_mesh
from debrisest.reconstruction.silhouettes import Frames, Reading
from debrisest.reconstruction.structure import Rig, Structure
from debrisest.reconstruction.turntable import Table, support_of, table_under
from debrisest.reconstruction.winding import pieces_of
from debrisest.vision.polyhedron import MassProperties, mass_properties

Method = Literal["poisson", "fusion"]
Support = Literal["found", "none"]
LEAST_COVERAGE, LEAST_GUESSED = 0.8, 0.6
"""Of the surface: below the first numbers are guesses, below the second there are none."""
_CELLS = (120, 200)
"""Cells along the body, of the coarse and of the fine surface."""
_DEPTH = (6, 7)
_NEAR = 0.025
"""Of the body's extent: how near a point of the cloud makes the surface a seen one."""
_HULL_CELLS = 60


class Body(NamedTuple):
    """What images tell of a body of density one; lengths in those of the structure."""

    mesh: ClosedMesh
    properties: MassProperties
    sigma: Array
    """1-sigma (10,) of volume, centre and inertia xx, yy, zz, xy, xz, yz."""
    method: Method
    cell: float
    """Side of the finer resolution's cells."""
    coverage: float
    """Share of the surface that the images show, but for a base on a table."""
    seen: BoolArray
    """Which triangles they show (triangle,)."""
    hull_volume: float
    """Of the convex hull, for a cross-check: the volume is no larger."""
    silhouette_volume: float
    """Of what all silhouettes share: the volume is no larger, but for their errors."""
    outline: str
    """What the body was taken to be in the images, in words."""
    on_table: bool
    """Whether it was closed below by the table on which it turned."""
    support_cut: bool
    """Whether this table was seen in the cloud, and cut off."""


def reconstructed_body(
    frames: Frames,
    readings: Sequence[Reading],
    rig: Rig,
    structure: Structure,
    method: Method = "fusion",
    known_length: tuple[float, float] | None = None,
    outline: Outline = "silhouettes",
    support: Support = "found",
) -> Body:
    """Return the body in images (time, camera, row, column) without distortion.

    ``readings`` are silhouettes; of several, those count that overlap most with the cloud. With a
    support "none" nothing is cut off below, nor closed by a plane.
    ``known_length`` is the longest distance between two points of the body, and its 1-sigma: it
    replaces the scale of the structure. Raises ValueError where no closed surface comes out.
    """
    whole = structure
    on_table = outline == "either" and support == "found"
    table = support_of(whole) if on_table else None
    if table is not None:
        structure = whole.of(table.below(whole.points) < 0.0)
    (masks, said, _), held = outlined(frames, readings, rig, structure, outline)
    structure = structure.of(held)
    outer = Outer(masks[:, 0], rig.matrix[0], structure, table)
    views = depth_views(frames, masks, rig, structure if table is None else whole)
    extent = float(np.ptp(structure.points, axis=0).max())
    cells = [extent / count for count in _CELLS]
    cloud = _cloud(views, outer, cells[0])
    if on_table and table is None:
        outer = outer.on(table_under(cloud.points, structure))
    coarse, mesh = _SURFACES[method](views, outer, cells)
    coverage = triangles_seen(mesh, cloud, _NEAR * extent)
    share = _share_seen(mesh, coverage, outer.table, cells[1])
    factor, scale_sigma = _scale(mesh, structure, known_length, cells[1])
    coarse, mesh = (each._replace(vertices=factor * each.vertices) for each in (coarse, mesh))
    doubts = Doubts(scale_sigma, factor * depth_sigma(views), 1.0 - share)
    return Body(
        mesh=mesh,
        properties=mass_properties(mesh.vertices, mesh.triangles),
        sigma=error_bars(mesh, coarse, doubts),
        method=method,
        cell=factor * cells[1],
        coverage=share,
        seen=coverage,
        hull_volume=factor**3 * _hull_volume(cloud.points),
        silhouette_volume=factor**3 * outer.volume(extent / _HULL_CELLS),
        outline=said,
        on_table=outer.table is not None,
        support_cut=table is not None,
    )


def _cloud(views: list[DepthView], outer: Outer, cell: float) -> OrientedCloud:
    """Return the dense cloud, as far as it lies in the silhouettes."""
    found = dense_cloud(views, cell)
    kept = outer.holds(found.points)
    if outer.table is not None:
        kept &= outer.table.below(found.points) < -cell
    return OrientedCloud(found.points[kept], found.normals[kept])


def _poisson(views: list[DepthView], outer: Outer, cells: list[float]) -> list[ClosedMesh]:
    clouds = [_cloud(views, outer, cell) for cell in cells]
    found = [poisson_mesh(cloud, depth) for cloud, depth in zip(clouds, _DEPTH)]
    return [closed_mesh(*_main_piece(*each)) for each in found]


def _main_piece(vertices: Array, triangles: IntArray) -> tuple[Array, IntArray]:
    """Return the connected piece with the most triangles: bubbles about it are none of the body."""
    piece = pieces_of(triangles)
    return vertices, triangles[piece == np.bincount(piece).argmax()]


def _fused(views: list[DepthView], outer: Outer, cells: list[float]) -> list[ClosedMesh]:
    grids = [fusion.grid_about(outer.structure.points, cell) for cell in cells]
    found = [fusion.fused_mesh(grid, fusion.near(grid, outer.outside), views) for grid in grids]
    return [closed_mesh(*each, of_voxels=True) for each in found]


_SURFACES = {"poisson": _poisson, "fusion": _fused}
"""Of depth images, silhouettes, and the sides of coarse and fine cells: coarse and fine mesh."""


def _share_seen(mesh: ClosedMesh, seen: BoolArray, table: Table | None, cell: float) -> float:
    """Return the share of the surface, without a base that stands on a table, that images show."""
    if table is None:
        return share_of_area(mesh, seen)
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    above = table.below(middles) < -cell
    return share_of_area(mesh, seen & above) / share_of_area(mesh, above)


def _hull_volume(points: Array) -> float:
    try:
        return float(scipy.spatial.ConvexHull(points).volume)
    except scipy.spatial.QhullError:
        raise ValueError("the points of the surface lie in a plane") from None


def _longest(vertices: Array) -> float:
    corners = vertices[scipy.spatial.ConvexHull(vertices).vertices]
    return float(max(np.linalg.norm(corners - corner, axis=1).max() for corner in corners))


def _scale(
    mesh: ClosedMesh, structure: Structure, known_length: tuple[float, float] | None, cell: float
) -> tuple[float, float]:
    """Return the factor that lengths take, and the relative 1-sigma of the scale."""
    if known_length is None:
        return 1.0, structure.scale_sigma
    length = _longest(mesh.vertices)
    relative = float(np.hypot(known_length[1] / known_length[0], cell / length))
    return known_length[0] / length, relative
