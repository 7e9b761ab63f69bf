"""Lists of cameras as image sets for reconstruction have them: a line for each image.

``name`` with nine numbers of the camera matrix, nine of the rotation and three of the translation,
row by row, or with the twelve of a projection matrix ``K [R t]``; both take points to the camera,
``x_c = R x + t``. A first line with the number of images may be there. Or a folder with a file for
each image, which has the same first number in its name, of the numbers alone.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array
from debrisest.errors import UserError
from debrisest.tracks.text import read_text

_FILES = (".txt", ".p", ".cam")
_SAME = 0.01
"""Of the focal length: how far the matrices of one camera may differ."""
_WANTED = "expected name K(9) R(9) t(3), or name P(12), numbers row by row"


_Place = tuple[Array, Array, Array]


class CameraPlaces(NamedTuple):
    """One camera and where it was in each image."""

    matrix: Array
    """Camera matrix (3, 3), px, the mean over the images."""
    rotation: Array
    """(image, 3, 3)."""
    translation: Array
    """(image, 3), in the unit of the file."""


def read_places(path: Path, names: Sequence[str]) -> CameraPlaces:
    """Return the camera of images, and its places in their order.

    Raises `UserError` with the line: other counts of numbers, no rotation, no positive focal
    length; an image without a camera; matrices that differ.
    """
    found = _of_folder(path) if path.is_dir() else _of_list(path)
    wanted = [_first_number(name) for name in names] if path.is_dir() else list(names)
    if lacking := [name for name, key in zip(names, wanted) if key not in found]:
        there = ", ".join(list(found)[:3]) or "nothing"
        raise UserError(f"{path}: no camera for the image {lacking[0]}; it has {there} ...")
    taken = [found[key] for key in wanted]
    matrix, rotation, translation = (np.stack(each) for each in zip(*taken))
    mean = matrix.mean(axis=0)
    if np.abs(matrix - mean).max() > _SAME * mean[0, 0]:
        raise UserError(
            f"{path}: the camera matrices differ by more than {_SAME:.0%}: one is taken"
        )
    return CameraPlaces(mean, rotation, translation)


def _of_list(path: Path) -> dict[str, _Place]:
    """Return the camera of each image by the name that its line has."""
    found = {}
    for number, line in enumerate(read_text(path).split("\n"), start=1):
        fields = line.split("#")[0].split()
        if len(fields) > 1:
            found[Path(fields[0]).name] = _camera(fields[1:], f"{path}:{number}")
    return found


def _of_folder(path: Path) -> dict[str, _Place]:
    """Return the camera of each image by the first number in the name of its file."""
    found = {}
    for file in sorted(one for one in path.iterdir() if one.suffix.lower() in _FILES):
        fields = read_text(file).split()
        found[_first_number(file.name)] = _camera(fields[fields[:1] == ["CONTOUR"] :], str(file))
    return found


def _first_number(name: str) -> str:
    """Return the first number in a name without its zeros, nothing where it has none."""
    digits = re.search("[0-9]+", name)
    return str(int(digits[0])) if digits else ""


def _camera(fields: list[str], where: str) -> _Place:
    """Return matrix, rotation and translation of an image."""
    try:
        values = np.array([float(field) for field in fields])
    except ValueError as error:
        raise UserError(f"{where}: {error}; {_WANTED}") from None
    if len(values) not in (12, 21) or not np.isfinite(values).all():
        raise UserError(f"{where}: {len(values)} numbers; {_WANTED}")
    if len(values) == 21:
        matrix, rotation = values[:18].reshape(2, 3, 3)
        translation = values[18:]
    else:
        matrix, rotation, translation = _factors(values.reshape(3, 4))
    proper = np.abs(rotation @ rotation.T - np.eye(3)).max() < 1e-2 and np.linalg.det(rotation) > 0
    if not (proper and matrix[0, 0] > 0 and matrix[1, 1] > 0):
        raise UserError(f"{where}: no rotation, or no positive focal length; {_WANTED}")
    return matrix, rotation, translation


def _factors(projection: Array) -> tuple[Array, Array, Array]:
    """Return the factors of a projection matrix (3, 4), known up to a factor."""
    matrix, rotation = scipy.linalg.rq(projection[:, :3])
    signs = np.sign(np.diag(matrix)) + (np.diag(matrix) == 0.0)
    matrix, rotation = matrix * signs, signs[:, None] * rotation
    shift = scipy.linalg.solve_triangular(matrix, projection[:, 3])
    turned = np.sign(np.linalg.det(rotation))
    return matrix / matrix[2, 2], turned * rotation, turned * shift
