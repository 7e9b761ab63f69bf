"""A calibration as OpenCV's YAML, which ``calibration`` and OpenCV read."""

from pathlib import Path

import numpy as np

from debrisest.arrays import Array
from debrisest.files import replacing
from debrisest.tracks.types import Camera, Rig


def write_calibration(path: Path, rig: Rig) -> None:
    """Write one camera, or a stereo pair with ``R`` and ``T`` from the first to the second."""
    pair = len(rig.cameras) > 1
    size = rig.cameras[0].size
    parts = ["%YAML:1.0\n---\n"]
    if size is not None:
        parts.append(f"image_width: {size[0]}\nimage_height: {size[1]}\n")
    names = [("M1", "D1"), ("M2", "D2")] if pair else [("camera_matrix", "distortion_coefficients")]
    for camera, (matrix, bent) in zip(rig.cameras, names):
        parts += [_matrix(matrix, camera_matrix(camera))]
        parts += [_matrix(bent, np.array([camera.distortion or (0.0,) * 5]))]
    if pair:
        parts += [_matrix("R", rig.rotation[1]), _matrix("T", rig.translation[1][:, None])]
    with replacing(path) as temporary:
        temporary.write_text("".join(parts), encoding="utf-8")


def camera_matrix(camera: Camera) -> Array:
    """Return the matrix (3, 3) of a camera, px."""
    (fx, fy), (cx, cy) = camera.focal_px, camera.centre_px
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def _matrix(name: str, values: Array) -> str:
    rows, columns = values.shape
    numbers = ", ".join(repr(float(value)) for value in values.ravel())
    return (
        f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n"
        f"   data: [ {numbers} ]\n"
    )
