"""Calibrations of one camera or of a stereo pair, from OpenCV's YAML or from plain keys.

OpenCV's files (``cv::FileStorage``) may be one or several: its stereo example writes intrinsics and
extrinsics apart. ``R`` and ``T`` take points of the first camera to the second,
``x_2 = R x_1 + T``; of a rectified pair the projection ``P2`` gives ``T``.
"""

import difflib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from debrisest.arrays import Array
from debrisest.errors import UserError
from debrisest.tracks.opencv_yaml import load_mapping
from debrisest.tracks.types import Camera, Rig

_MATRIX = ("camera_matrix", "cameraMatrix", "K", "M1", "K1", "cameraMatrix1", "camera_matrix_left")
_SECOND = ("M2", "K2", "cameraMatrix2", "camera_matrix_right")
_BENT = ("distortion_coefficients", "distCoeffs", "dist_coeffs", "D", "D1", "distCoeffs1")
_BENT_2 = ("D2", "distCoeffs2")
_ROTATION, _TRANSLATION, _PROJECTION = ("R",), ("T",), ("P2",)
_PLAIN = ("fx_px", "fy_px", "cx_px", "cy_px", "distortion", "baseline_m", "width_px", "height_px")
_LONGEST = 10.0  # m: a longer base in OpenCV's file is one in millimetres


def read_calibration(*paths: Path) -> Rig:
    """Cameras of one or several calibration files.

    Raises `UserError`: not YAML, unknown plain keys, matrices of another shape, a focal length that
    is not positive, a rotation that is none, a baseline in millimetres.
    """
    held: dict[str, Any] = {}
    for path in paths:
        held |= load_mapping(path)
    source = ", ".join(str(path) for path in paths)
    if any(key in held for key in ("fx_px", "fy_px", "cx_px", "cy_px")):
        return _plain(held, source)
    if any(key in held for key in _MATRIX):
        return _opencv(held, source)
    keys = f"{', '.join(_PLAIN[:4])} (plain keys) or {_MATRIX[0]}, K, M1 (OpenCV's)"
    raise UserError(f"{source}: no camera here; expected {keys}, found {', '.join(held)[:100]}")


def _plain(held: dict[str, Any], source: str) -> Rig:
    for key in held:
        if key not in _PLAIN:
            close = difflib.get_close_matches(key, _PLAIN, n=1)
            hint = f"did you mean {close[0]}?" if close else f"allowed are {', '.join(_PLAIN)}"
            raise UserError(f"{source}: unknown key {key}; {hint}")
    fx, fy, cx, cy = (_number(held, key, source) for key in _PLAIN[:4])
    bent = _array(held.get("distortion", []), "distortion", source).ravel()
    size = None
    if "width_px" in held or "height_px" in held:
        size = (int(_number(held, "width_px", source)), int(_number(held, "height_px", source)))
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    first = _camera("left" if "baseline_m" in held else "camera", matrix, bent, size, source)
    if "baseline_m" not in held:
        return Rig((first,), np.eye(3)[None], np.zeros((1, 3)))
    base = _number(held, "baseline_m", source)
    second = _camera("right", matrix, bent, size, source)
    return _pair(first, second, np.eye(3), np.array([-base, 0.0, 0.0]), source)


def _opencv(held: dict[str, Any], source: str) -> Rig:
    size = None
    width, height = (_first(held, (f"image_{what}",)) for what in ("width", "height"))
    if width is not None and height is not None:
        size = (
            int(_array(width, "image_width", source)),
            int(_array(height, "image_height", source)),
        )
    matrix = _shaped(held, _MATRIX, (3, 3), source)
    bent = _array(_first(held, _BENT, []), _BENT[0], source).ravel()
    if (second := _first(held, _SECOND)) is None:
        return Rig(
            (_camera("camera", matrix, bent, size, source),), np.eye(3)[None], np.zeros((1, 3))
        )
    first = _camera("left", matrix, bent, size, source)
    other = _array(_first(held, _BENT_2, []), _BENT_2[0], source).ravel()
    right = _camera("right", _array(second, _SECOND[0], source), other, size, source)
    if "T" in held:
        rotation = _shaped(held, _ROTATION, (3, 3), source)
        return _pair(first, right, rotation, _shaped(held, _TRANSLATION, (3,), source), source)
    if "P2" in held:
        projection = _shaped(held, _PROJECTION, (3, 4), source)
        shift = np.array([projection[0, 3] / projection[0, 0], 0.0, 0.0])
        return _pair(first, right, np.eye(3), shift, source)
    raise UserError(f"{source}: two cameras, but neither R and T nor P2 say how they are mounted")


def _pair(first: Camera, second: Camera, rotation: Array, shift: Array, source: str) -> Rig:
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-3 or np.linalg.det(rotation) < 0:
        raise UserError(f"{source}: R is not a rotation matrix")
    base = float(np.linalg.norm(shift))
    if not 0 < base <= _LONGEST:
        message = f"a baseline of {base:g} m; T (or baseline_m) must be in metres, above zero"
        raise UserError(f"{source}: {message}, at most {_LONGEST:g}: is it in millimetres?")
    rotations, shifts = np.stack([np.eye(3), rotation]), np.stack([np.zeros(3), shift])
    return Rig((first, second), rotations, shifts, (f"baseline {base:g} m",))


def _camera(
    name: str, matrix: Array, bent: Array, size: tuple[int, int] | None, source: str
) -> Camera:
    if matrix.shape != (3, 3) or not (matrix[0, 0] > 0 and matrix[1, 1] > 0):
        raise UserError(f"{source}: {name}: focal lengths must be positive, in a 3 x 3 matrix")
    if len(bent) not in (0, 4, 5, 8, 12, 14):
        raise UserError(
            f"{source}: {name}: {len(bent)} distortion coefficients; OpenCV has 4 to 14"
        )
    focal, centre = (matrix[0, 0], matrix[1, 1]), (matrix[0, 2], matrix[1, 2])
    return Camera(
        name, (float(focal[0]), float(focal[1])), (float(centre[0]), float(centre[1])),
        tuple(bent.tolist()), size,
    )  # fmt: skip


def _first(held: dict[str, Any], names: Sequence[str], default: Any = None) -> Any:
    return next((held[name] for name in names if name in held), default)


def _number(held: dict[str, Any], key: str, source: str) -> float:
    if key not in held:
        raise UserError(f"{source}: {key} is missing")
    value = _array(held[key], key, source)
    if value.ndim:
        raise UserError(f"{source}: {key}: expected one number, found {str(held[key])[:40]}")
    return float(value)


def _shaped(
    held: dict[str, Any], names: Sequence[str], shape: tuple[int, ...], source: str
) -> Array:
    value = _first(held, names)
    if value is None:
        raise UserError(f"{source}: {names[0]} is missing")
    array = _array(value, names[0], source)
    if array.size != np.prod(shape):
        wanted = " x ".join(str(length) for length in shape)
        raise UserError(f"{source}: {names[0]}: expected {wanted} numbers, found {array.shape}")
    return array.reshape(shape)


def _array(value: Any, key: str, source: str) -> Array:
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise UserError(f"{source}: {key}: expected numbers, found {str(value)[:40]!r}") from None
    if not np.isfinite(array).all():
        raise UserError(f"{source}: {key}: not finite")
    return array
