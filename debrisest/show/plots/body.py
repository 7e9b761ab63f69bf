"""A reconstructed body: its cloud, its mesh with principal axes, and what was seen of it."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from debrisest.arrays import Array, Data
from debrisest.show.plots.axes import heading
from debrisest.show.plots.space import same_scale, spatial_axes
from debrisest.show.plots.style import BLUE, GREY, INK, VERMILION, WIDTH, styled
from debrisest.vision.polyhedron import face_normals

CLOUD = ("cloud_point_r", "cloud_seen")
MESH = ("vertex_r", "triangle_r", "triangle_seen", "principal_axes_r")
_SUN = np.array([0.4, -0.5, 0.77])


@styled
def cloud(data: Data, context: str) -> Figure:
    """Draw ``cloud_point (point, 3)``, darker where more frames see a point."""
    points = data["cloud_point_r"]
    kept = np.isfinite(points[:, 0])
    seen = np.nansum(data["cloud_seen"], axis=0)[kept]
    figure, top, axes = _space()
    axes.scatter(*points[kept].T, c=np.log(1.0 + seen), cmap="viridis_r", s=1.5, linewidths=0)
    _frame(axes, points[kept])
    heading(top, f"Points of the surface: {int(kept.sum())}", context)
    return figure


@styled
def mesh(data: Data, context: str) -> Figure:
    """Draw the mesh and, where they are told, its principal axes 1, 2 and 3."""
    corners = _corners(data)
    figure, top, axes = _space()
    _shade(axes, corners, np.tile([0.75, 0.78, 0.82], (len(corners), 1)))
    _principal_axes(axes, data, corners)
    _frame(axes, corners.reshape(-1, 3))
    heading(top, "Mesh and principal axes", context)
    return figure


@styled
def coverage(data: Data, context: str) -> Figure:
    """Draw the mesh, blue where an image shows the surface and red where none does."""
    corners = _corners(data)
    seen = data["triangle_seen"][: len(corners)] == 1.0
    colours = np.array([_rgb(VERMILION), _rgb(BLUE)])[seen.astype(int)]
    figure, top, axes = _space()
    _shade(axes, corners, colours)
    _frame(axes, corners.reshape(-1, 3))
    share = float(data.get("surface_seen", np.nan))
    heading(top, f"Seen: blue; never seen: red ({share:.0%} of the surface are seen)", context)
    return figure


def _space() -> tuple[Figure, Any, Any]:
    figure = Figure(figsize=(WIDTH, 5.2))
    top, axes = spatial_axes(figure, ("x", "y", "z"))
    return figure, top, axes


def _frame(axes: Any, points: Array) -> None:
    same_scale(axes, points)
    axes.view_init(elev=22, azim=-52)


def _corners(data: Data) -> Array:
    triangles = data["triangle_r"]
    kept = triangles[np.isfinite(triangles[:, 0])].astype(np.int64)
    return np.asarray(data["vertex_r"][kept])


def _shade(axes: Any, corners: Array, colours: Array) -> None:
    """Add triangles (triangle, 3, 3) in light from one side."""
    normals = face_normals(corners)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    light = 0.55 + 0.45 * (normals @ (_SUN / np.linalg.norm(_SUN)))
    faces = np.clip(colours * light[:, None], 0.0, 1.0)
    axes.add_collection3d(
        Poly3DCollection(
            corners, facecolors=faces, edgecolors=faces, linewidths=0.1, rasterized=True
        )
    )


def _principal_axes(axes: Any, data: Data, corners: Array) -> None:
    centre, turn = data["centre_r"], data["principal_axes_r"]
    if not np.isfinite(turn).all():
        return
    if not np.isfinite(centre).all():
        centre = corners.mean(axis=(0, 1))
    reach = (corners - centre) @ turn
    for number in range(3):
        half = 1.25 * np.abs(reach[..., number]).max()
        line = centre + np.outer([-half, half], turn[:, number])
        axes.plot(*line.T, color=INK, linewidth=1.0, zorder=10)
        axes.text(*line[1], str(number + 1), color=INK, zorder=11)
    axes.plot(*np.array(centre)[:, None], "o", color=GREY, markersize=3, zorder=12)


def _rgb(colour: str) -> tuple[float, ...]:
    from matplotlib.colors import to_rgb

    return to_rgb(colour)
