"""A mesh of a file as the datasets of a body, and back; first guesses that follow from them."""

from pathlib import Path

import numpy as np

from debrisest.arrays import Array, Data, IntArray
from debrisest.dynamics import inertia_ratios
from debrisest.files import put
from debrisest.reconstruction.closed_mesh import closed_mesh
from debrisest.reconstruction.oriented import oriented
from debrisest.reconstruction.poisson import poisson_mesh
from debrisest.vision.polyhedron import mass_properties

_CLOUD_DEPTH = 6


def mesh_data(vertices: Array, triangles: IntArray, density: float, mass: float | None) -> Data:
    """Return what a body of one density tells, without run axis; from a cloud by its surface.

    Raises ValueError, with counts, for what bounds no body.
    """
    said = "closed mesh, as it was given"
    if not len(triangles):
        vertices, triangles = poisson_mesh(oriented(vertices), _CLOUD_DEPTH)
        said = "screened Poisson surface of the cloud, taken to face away from its middle"
    mesh = closed_mesh(vertices, triangles)
    found = mass_properties(mesh.vertices, mesh.triangles)
    density = density if mass is None else mass / found.volume
    moments, axes = np.linalg.eigh(found.inertia * density)
    return {
        "mesh_method": np.array(said),
        "mended": np.array("; ".join(mesh.mended)),
        "volume": np.array(found.volume),
        "body_mass": np.array(found.volume * density),
        "centre_r": found.centre,
        "body_inertia_r": found.inertia * density,
        "principal_moments": moments,
        "principal_axes_r": axes * np.sign(np.linalg.det(axes)),
        "moment_ratios": inertia_ratios.ratios(moments),
        "vertex_r": mesh.vertices,
        "triangle_r": mesh.triangles.astype(np.float64),
    }


def body_mesh(data: Data) -> tuple[Array, IntArray]:
    """Return vertices and triangles of a body's datasets, without what fills them up."""
    triangles = data["triangle_r"]
    kept = triangles[np.isfinite(triangles[:, 0])].astype(np.int64)
    vertices = data["vertex_r"]
    return vertices[np.isfinite(vertices[:, 0])], kept


def start_table(path: Path, data: Data) -> None:
    """Write the inertia ratios and their sigma as a first guess, as ``starts: given`` reads it."""
    rows = [
        f"inertia_ratio,{index + 1},{value!r},{sigma!r}"
        for index, (value, sigma) in enumerate(
            zip(data["moment_ratios"].tolist(), data["moment_ratios_sigma"].tolist())
        )
    ]
    put(path, "\n".join(["name,component,value,sigma", *rows, ""]).encode())
