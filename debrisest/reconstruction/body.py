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
from debrisest.reconstruction.outlines import main_part, outlines
from debrisest.reconstruction.poisson import poisson_mesh
from debrisest.reconstruction.silhouettes import Frames, Reading
from debrisest.reconstruction.structure import Rig, Structure
from debrisest.reconstruction.turntable import Table, lowered, support_of, table_under
from debrisest.reconstruction.winding import pieces_of
from debrisest.vision.polyhedron import MassProperties, mass_properties

Method = Literal["poisson", "fusion"]
Outline = Literal["silhouettes", "either"]
Support = Literal["found", "none"]
LEAST_COVERAGE, LEAST_GUESSED = 0.8, 0.6
"""Of the surface: below the first numbers are guesses, below the second there are none."""
_ANYWHERE = 3.0
"""Thirds of its distance from the centre that a guess lets unseen surface be off."""
_CELLS = (120, 200)
"""Cells along the body, of the coarse and of the fine surface."""
_DEPTH = (6, 7)
_NEAR = 0.025
"""Of the body's extent: how near a point of the cloud makes the surface a seen one."""
_NEXT_PX = 2.0
_AGREED, _AGREED_GIVEN = 0.8, 0.1
"""Share of the structure's points that silhouettes must hold: most, and if they were given some,
since a table that turns with the body has points too."""
_BY_CLOUD = "the hull of the cloud, since silhouettes do not tell the body: hollows fill"
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
    (masks, said, _), held = _outlined(frames, readings, rig, structure, outline)
    structure = structure.of(held)
    outer = _Outer(masks[:, 0], rig.matrix[0], structure, table)
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
    unseen = (1.0 - share) * (1.0 if share >= LEAST_COVERAGE else _ANYWHERE)
    doubts = Doubts(scale_sigma, factor * depth_sigma(views), unseen)
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


def _outlined(
    frames: Frames,
    readings: Sequence[Reading],
    rig: Rig,
    structure: Structure,
    outline: Outline,
) -> tuple[Reading, BoolArray]:
    """Return silhouettes, and which points (point,) they hold."""
    held = [
        _Outer(one.masks[:, 0], rig.matrix[0], structure).holds(structure.points)
        for one in readings
    ]
    if any(one.given for one in readings):
        return _given(readings[0], held[0])
    if outline == "silhouettes":
        if held[0].mean() < _AGREED:
            raise ValueError(
                "the structure does not agree with the silhouettes, which hold "
                f"{held[0].mean():.0%} of its points: images were placed wrongly; take more of "
                "them, or larger ones"
            )
        return readings[0], held[0]
    part = main_part(structure)
    drawn = outlines(structure.of(part), rig.matrix[0], frames.shape[2:])
    agree = [place for place, each in enumerate(held) if each.mean() >= _AGREED]
    if not agree:
        return Reading(np.repeat(drawn[:, None], frames.shape[1], axis=1), _BY_CLOUD), part
    best = max(agree, key=lambda place: _overlap(readings[place].masks[:, 0], drawn))
    return readings[best], held[best]


def _given(reading: Reading, held: BoolArray) -> tuple[Reading, BoolArray]:
    """Return masks that were given with the points they hold, or raise ValueError for too few."""
    if held.mean() < _AGREED_GIVEN:
        raise ValueError(
            f"the masks hold {held.mean():.0%} of the structure's points: are they of these "
            "images, in their order?"
        )
    return reading, held


def _overlap(masks: BoolArray, drawn: BoolArray) -> float:
    """Return the share of what either of two outlines holds that both do, where one is drawn."""
    there = drawn.any(axis=(1, 2))
    return float((masks & drawn)[there].sum() / (masks | drawn)[there].sum())


class _Outer(NamedTuple):
    """Silhouettes of the first camera (time, row, column), its matrix and its places; a table."""

    masks: BoolArray
    matrix: Array
    structure: Structure
    table: Table | None = None

    def outside(self, points: Array | fusion.Values) -> fusion.Values:
        """Return how far points (n, 3) lie outside of silhouettes, or below the table (n,), m."""
        found = fusion.outside_silhouettes(points, self.masks, self.matrix, self.structure)
        if self.table is None:
            return found
        return np.maximum(found, self.table.below(np.asarray(points, float)).astype(np.float32))

    def on(self, table: Table | None) -> "_Outer":
        """Return the same on a table, as low as the silhouettes let it be."""
        if table is None:
            return self
        low = lowered(table, self.structure.points, self.outside, self.pixel)
        return self._replace(table=low)

    @property
    def pixel(self) -> float:
        """Return what a pixel makes at the body, m."""
        away = self.structure.translation[self.structure.registered]
        return float(np.median(np.linalg.norm(away, axis=1)) / self.matrix[0, 0])

    def holds(self, points: Array) -> BoolArray:
        """Return which points (n, 3) lie in the silhouettes, or next to them."""
        return np.asarray(self.outside(points) < _NEXT_PX * self.pixel)

    def volume(self, voxel: float) -> float:
        """Return the volume of what all silhouettes share."""
        grid = fusion.grid_about(self.structure.points, voxel)
        return float((self.outside(grid.points) < 0.0).sum() * voxel**3)


def _cloud(views: list[DepthView], outer: _Outer, cell: float) -> OrientedCloud:
    """Return the dense cloud, as far as it lies in the silhouettes."""
    found = dense_cloud(views, cell)
    kept = outer.holds(found.points)
    if outer.table is not None:
        kept &= outer.table.below(found.points) < -cell
    return OrientedCloud(found.points[kept], found.normals[kept])


def _poisson(views: list[DepthView], outer: _Outer, cells: list[float]) -> list[ClosedMesh]:
    clouds = [_cloud(views, outer, cell) for cell in cells]
    found = [poisson_mesh(cloud, depth) for cloud, depth in zip(clouds, _DEPTH)]
    return [closed_mesh(*_main_piece(*each)) for each in found]


def _main_piece(vertices: Array, triangles: IntArray) -> tuple[Array, IntArray]:
    """Return the connected piece with the most triangles: bubbles about it are none of the body."""
    piece = pieces_of(triangles)
    return vertices, triangles[piece == np.bincount(piece).argmax()]


def _fused(views: list[DepthView], outer: _Outer, cells: list[float]) -> list[ClosedMesh]:
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
