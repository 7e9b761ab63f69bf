"""A closed surface through oriented points: screened Poisson (Kazhdan and Hoppe 2013).

The library COLMAP has it; it runs in a process of its own: ``python -m ... CLOUD MESH DEPTH``.
"""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.reconstruction.dense_cloud import OrientedCloud
from debrisest.reconstruction.mesh_files import read_mesh
from debrisest.vision.libraries import vision_library

_COLUMNS = ("x", "y", "z", "nx", "ny", "nz")
_COLOURS = ("red", "green", "blue")


def poisson_mesh(cloud: OrientedCloud, depth: int) -> tuple[Array, IntArray]:
    """Return vertices and triangles; a cube about the cloud is halved ``depth`` times.

    Raises ValueError where the library makes no surface of it, and UserError without it.
    """
    vision_library("pycolmap")
    with TemporaryDirectory() as folder:
        points, mesh = Path(folder) / "cloud.ply", Path(folder) / "mesh.ply"
        _write(points, cloud)
        command = [sys.executable, "-m", __name__, str(points), str(mesh), str(depth)]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
        if ended.returncode or not mesh.is_file():
            raise ValueError("the points of the surface do not close to a body")
        vertices, triangles = read_mesh(mesh)
    if not len(triangles):
        raise ValueError("the points of the surface do not close to a body")
    return vertices, triangles


def _write(path: Path, cloud: OrientedCloud) -> None:
    """Write a binary PLY as the library reads it."""
    columns = [(name, "<f4") for name in _COLUMNS] + [(name, "u1") for name in _COLOURS]
    rows: Any = np.zeros(len(cloud.points), dtype=columns)
    for name, values in zip(_COLUMNS, np.concatenate(cloud, axis=1).T):
        rows[name] = values
    told = [f"property float {name}" for name in _COLUMNS]
    told += [f"property uchar {name}" for name in _COLOURS]
    count = f"element vertex {len(rows)}"
    header = ["ply", "format binary_little_endian 1.0", count, *told, "end_header", ""]
    path.write_bytes("\n".join(header).encode() + rows.tobytes())


def main(cloud: str, mesh: str, depth: str) -> None:
    """Read a cloud and write its mesh."""
    colmap = vision_library("pycolmap")
    options = colmap.PoissonMeshingOptions(depth=int(depth), trim=0.0, num_threads=1, color=False)
    colmap.poisson_meshing(cloud, mesh, options)


if __name__ == "__main__":
    main(*sys.argv[1:])
