"""A COLMAP text model: its images are epochs, its points features, its camera poses poses.

Format: COLMAP's ``cameras.txt``, ``images.txt`` (two lines an image) and ``points3D.txt``. There
``q`` and ``t`` take points of the model into the camera, ``x_c = R(q) x + t``, scalar first; pixels
count from the image's corner with the middle of the first pixel at 0.5. The scale of such a model
is arbitrary unless it was aligned: its lengths are metres in name only, which is noted.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.errors import UserError
from debrisest.tracks.assemble import Rows, assemble, codes
from debrisest.tracks.frames import Times, frame_times
from debrisest.tracks.numbers import to_numbers
from debrisest.tracks.poses import poses_of
from debrisest.tracks.report import Report
from debrisest.tracks.text import read_text
from debrisest.tracks.types import BodyPoints, Camera, Poses, Tracks

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
class ColmapModel:
    """Pixel tracks of a model, the poses of the body in its camera, its points and cameras.

    ``poses`` are those of the camera with most images.
    """

    tracks: Tracks
    poses: Poses
    body: BodyPoints
    cameras: tuple[Camera, ...]


@dataclass(frozen=True)
class _Image:
    name: str
    camera: str
    pose: Array
    line: int
    seen: Array  # rows of u, v and the point's number


def read_colmap(
    folder: Path, rate_hz: float | None = None, times: Times | None = None
) -> ColmapModel:
    """Read a folder with a COLMAP text model; times as in `frame_times`.

    Raises `UserError` with file and line: wrong counts, camera models that are not known, images
    of a camera, or of a point, that the model lacks.
    """
    if missing := [name for name in FILES if not (folder / name).is_file()]:
        binary = (folder / "images.bin").exists()
        hint = "; convert it: colmap model_converter --output_type TXT" if binary else ""
        raise UserError(f"{folder}: no COLMAP text model: {', '.join(missing)} missing{hint}")
    cameras, body = _cameras(folder / FILES[0]), _points(folder / FILES[2])
    images = _images(folder / FILES[1], {camera.name for camera in cameras}, set(body.features))
    names = [image.name for image in images]
    time, note = frame_times(names, str(folder / FILES[1]), rate_hz, times)
    return ColmapModel(
        _tracks(folder / FILES[1], images, time, note),
        _poses(folder / FILES[1], images, time, note),
        body,
        cameras,
    )


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(read_text(path).removesuffix("\n").split("\n"), 1):
        if not line.startswith("#"):
            yield number, line


def _numbers(fields: list[str], line: int, report: Report) -> Array:
    values, wrong = to_numbers(fields) if fields else (np.zeros(0), np.zeros(0, bool))
    for index in np.flatnonzero(wrong | np.isnan(values))[:3]:
        report.add(line, f"{fields[index][:30]!r} is not a number")
    return values


def _cameras(path: Path) -> tuple[Camera, ...]:
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


def _points(path: Path) -> BodyPoints:
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


def _images(path: Path, cameras: set[str], points: set[str]) -> list[_Image]:
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


def _image(fields: list[str], line: int, seen: str, below: int, report: Report) -> _Image:
    pose = _numbers(fields[1:8], line, report)
    values = _numbers(seen.split(), below, report)
    if len(values) % 3:
        report.add(below, "expected triples X Y POINT3D_ID; is the line cut?")
    rows = np.nan_to_num(values[: len(values) // 3 * 3].reshape(-1, 3), nan=-1.0)
    return _Image(fields[9].strip(), fields[8], pose, line, rows)


def _tracks(path: Path, images: list[_Image], time: Array, note: str) -> Tracks:
    kept = [image.seen[image.seen[:, 2] >= 0] for image in images]
    counts = [len(seen) for seen in kept]
    seen = np.concatenate(kept)
    if not len(seen):
        raise UserError(f"{path}: no image sees a point of the model")
    feature, features = codes([str(int(number)) for number in seen[:, 2]])
    camera, cameras = codes([image.camera for image in images])
    lines = np.array([image.line + 1 for image in images])
    rows = Rows(
        str(path), np.repeat(time, counts), feature, np.repeat(camera, counts),
        np.repeat(lines, counts), features, cameras, None, None, seen[:, :2], None,
    )  # fmt: skip
    return assemble(rows, (f"{len(images)} images of a COLMAP model", note))


def _poses(path: Path, images: list[_Image], time: Array, note: str) -> Poses:
    camera: IntArray
    camera, names = codes([image.camera for image in images])
    most = int(np.argmax(np.bincount(camera)))
    mine = np.flatnonzero(camera == most)
    pose = np.array([images[index].pose for index in mine])
    lines = np.array([images[index].line for index in mine])
    notes = (f"poses of the model in camera {names[most]}, in the model's scale", note)
    return poses_of(str(path), time[mine], pose[:, :4], pose[:, 4:], None, lines, notes)
