"""The three files of a COLMAP text model, line by line.

Format: COLMAP's ``cameras.txt``, ``images.txt`` (two lines an image) and ``points3D.txt``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from debrisest.arrays import Array
from debrisest.errors import UserError
from debrisest.tracks.numbers import to_numbers
from debrisest.tracks.report import Report
from debrisest.tracks.text import read_text
from debrisest.tracks.types import BodyPoints, Camera

FILES = ("cameras.txt", "images.txt", "points3D.txt")
_MODELS = {  # parameters of each model: focal lengths, centre, distortion as OpenCV orders it
    "SIMPLE_PINHOLE": ((0, 0), (1, 2), ()),
    "PINHOLE": ((0, 1), (2, 3), ()),
    "SIMPLE_RADIAL": ((0, 0), (1, 2), (3,)),
    "RADIAL": ((0, 0), (1, 2), (3, 4)),
    "OPENCV": ((0, 1), (2, 3), (4, 5, 6, 7)),
    "FULL_OPENCV": ((0, 1), (2, 3), (4, 5, 6, 7, 8, 9, 10, 11)),
}


@dataclass(frozen=True)
class Image:
    """An image: ``pose`` (q, t) of the body in the camera; ``seen`` rows of u, v, point or -1."""

    name: str
    camera: str
    pose: Array
    line: int
    seen: Array


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(read_text(path).removesuffix("\n").split("\n"), 1):
        if not line.startswith("#"):
            yield number, line


def _numbers(fields: list[str], line: int, report: Report) -> Array:
    values, wrong = to_numbers(fields) if fields else (np.zeros(0), np.zeros(0, bool))
    for index in np.flatnonzero(wrong | np.isnan(values))[:3]:
        report.add(line, f"{fields[index][:30]!r} is not a number")
    return values


def read_cameras(path: Path) -> tuple[Camera, ...]:
    """Cameras of ``cameras.txt``, with distortion in OpenCV's order. Raises `UserError`."""
    report, cameras = Report(str(path)), {}
    for line, text in _lines(path):
        if not (fields := text.split()):
            continue
        if len(fields) < 5 or fields[1] not in _MODELS:
            known = ", ".join(_MODELS)
            report.add(line, f"expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS with MODEL of {known}")
            continue
        focal, centre, bent = _MODELS[fields[1]]
        values, count = _numbers(fields[2:], line, report), 2 + max(*focal, *centre, *bent) + 1
        if len(values) != count:
            report.add(line, f"{fields[1]} has {count - 2} parameters, not {len(values) - 2}")
        elif fields[0] in cameras:
            report.add(line, f"camera {fields[0]} is there twice")
        elif not report.count:
            size, p = (int(values[0]), int(values[1])), values[2:].tolist()
            f, c, d = ([p[index] for index in group] for group in (focal, centre, bent))
            d += [0.0] * (4 - len(d)) if d else []
            cameras[fields[0]] = Camera(fields[0], (f[0], f[1]), (c[0], c[1]), tuple(d), size)
    if not (cameras or report.count):
        report.add(0, "no camera in this file")
    report.check()
    return tuple(cameras.values())


def read_points(path: Path) -> BodyPoints:
    """Points of ``points3D.txt``, named by their numbers. Raises `UserError`."""
    report, points = Report(str(path)), {}
    for line, text in _lines(path):
        if not (fields := text.split()):
            continue
        if len(fields) < 8 or not fields[0].isdecimal():
            report.add(line, "expected POINT3D_ID X Y Z R G B ERROR TRACK; is the line cut?")
        elif fields[0] in points:
            report.add(line, f"point {fields[0]} is there twice")
        else:
            points[fields[0]] = _numbers(fields[1:4], line, report)
    report.check()
    if not points:
        raise UserError(f"{path}: no points in this model")
    note = "lengths are those of the COLMAP model: metres only if it was scaled"
    return BodyPoints(str(path), tuple(points), np.array(list(points.values())), (note,))


def read_images(path: Path, cameras: set[str], points: set[str]) -> list[Image]:
    """Images of ``images.txt``, of the cameras and points given. Raises `UserError`."""
    report, images, names = Report(str(path)), [], set()
    lines = _lines(path)
    for line, text in lines:
        if not (fields := text.split(maxsplit=9)):
            continue
        below, seen = next(lines, (line, None))
        if len(fields) < 10 or seen is None:
            report.add(line, "expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, points below")
            break  # lines come in pairs: what follows cannot be told apart
        image = _image(fields, line, seen, below, report)
        if image.camera not in cameras:
            report.add(line, f"camera {image.camera} is not in cameras.txt")
        if image.name in names:
            report.add(line, f"image {image.name} is there twice")
        names.add(image.name)
        if unknown := {str(int(n)) for n in image.seen[:, 2] if n >= 0} - points:
            report.add(below, f"point {min(unknown)} is not in points3D.txt")
        images.append(image)
    if not (images or report.count):
        report.add(0, "no image in this file")
    report.check()
    return images


def _image(fields: list[str], line: int, seen: str, below: int, report: Report) -> Image:
    pose = _numbers(fields[1:8], line, report)
    values = _numbers(seen.split(), below, report)
    if len(values) % 3:
        report.add(below, "expected triples X Y POINT3D_ID; is the line cut?")
    rows = np.nan_to_num(values[: len(values) // 3 * 3].reshape(-1, 3), nan=-1.0)
    return Image(fields[9].strip(), fields[8], pose, line, rows)
