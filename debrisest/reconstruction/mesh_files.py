"""Triangle meshes and point clouds in files: OBJ, STL, PLY."""

from pathlib import Path

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.errors import UserError
from debrisest.files import put
from debrisest.vision.libraries import vision_library

SUFFIXES = (".obj", ".stl", ".ply")
_WANTED = "give a triangle mesh as OBJ, STL or PLY"


def read_mesh(path: Path) -> tuple[Array, IntArray]:
    """Return vertices (vertex, 3) as the file has them and triangles (triangle, 3).

    A point cloud has no triangles. Raises UserError for what is no such file.
    """
    trimesh = vision_library("trimesh")
    if not path.is_file():
        raise UserError(f"{path}: no such file; {_WANTED}")
    if path.suffix.lower() not in SUFFIXES:
        raise UserError(
            f"{path}: files {path.suffix or 'without an ending'} are not read; {_WANTED}"
        )
    try:
        found = trimesh.load(path, process=False)
        parts = list(found.geometry.values()) if hasattr(found, "geometry") else [found]
        whole = trimesh.util.concatenate(parts) if len(parts) > 1 else parts[0]
        vertices = np.asarray(whole.vertices, dtype=np.float64).reshape(-1, 3)
    except Exception as error:  # each format's reader raises its own
        raise UserError(f"{path}: cannot be read ({error}); {_WANTED}") from None
    if not len(vertices):
        raise UserError(f"{path}: holds no points; {_WANTED}")
    triangles = np.asarray(getattr(whole, "faces", np.empty((0, 3))), dtype=np.int64)
    return vertices, triangles


def write_mesh(path: Path, vertices: Array, triangles: IntArray) -> None:
    """Write a mesh, or without triangles a cloud, as the ending of the path says."""
    trimesh = vision_library("trimesh")
    one = trimesh.Trimesh(vertices, triangles, process=False)
    shape = one if len(triangles) else trimesh.PointCloud(vertices)
    content = shape.export(file_type=path.suffix.lstrip(".").lower())
    put(path, content.encode() if isinstance(content, str) else content)
