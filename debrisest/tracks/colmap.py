"""A COLMAP text model: its images are epochs, its points features, its camera poses poses.

There ``q`` and ``t`` take points of the model into the camera, ``x_c = R(q) x + t``, scalar first;
pixels count from the image's corner, the middle of the first one is at 0.5. The scale of a model is
arbitrary unless it was aligned: its lengths are metres in name only, which is noted.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.errors import UserError
from debrisest.tracks.assemble import assemble
from debrisest.tracks.colmap_files import (
    FILES,
    Image,
    read_cameras,
    read_images,
    read_points,
)
from debrisest.tracks.frames import Times, frame_times
from debrisest.tracks.poses import poses_of
from debrisest.tracks.rows import Rows, codes
from debrisest.tracks.types import BodyPoints, Camera, Poses, Tracks


@dataclass(frozen=True)
class ColmapModel:
    """Pixel tracks of a model, the poses of the body in its camera, its points and cameras.

    ``poses`` are those of the camera with most images.
    """

    tracks: Tracks
    poses: Poses
    body: BodyPoints
    cameras: tuple[Camera, ...]


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
    cameras, body = read_cameras(folder / FILES[0]), read_points(folder / FILES[2])
    images = read_images(folder / FILES[1], {camera.name for camera in cameras}, set(body.features))
    names = [image.name for image in images]
    time, note = frame_times(names, str(folder / FILES[1]), rate_hz, times)
    return ColmapModel(
        _tracks(folder / FILES[1], images, time, note),
        _poses(folder / FILES[1], images, time, note),
        body,
        cameras,
    )


def _tracks(path: Path, images: list[Image], time: Array, note: str) -> Tracks:
    kept = [image.seen[image.seen[:, 2] >= 0] for image in images]
    counts = [len(seen) for seen in kept]
    seen, of_image = np.concatenate(kept), np.repeat(np.arange(len(images)), counts)
    seen, of_image, doubtful = _seen_once(seen, of_image)
    if not len(seen):
        raise UserError(f"{path}: no image sees a point of the model")
    feature, features = codes([str(int(number)) for number in seen[:, 2]])
    camera, cameras = codes([image.camera for image in images])
    lines = np.array([image.line + 1 for image in images])
    rows = Rows(
        str(path), time[of_image], feature, camera[of_image], lines[of_image], features,
        cameras, None, None, seen[:, :2], None,
    )  # fmt: skip
    return assemble(rows, (f"{len(images)} images of a COLMAP model", note, *doubtful))


def _seen_once(seen: Array, of_image: IntArray) -> tuple[Array, IntArray, tuple[str, ...]]:
    """Leave out points that an image has at two places, as COLMAP may give them."""
    pairs = np.column_stack([of_image, seen[:, 2]])
    _, index, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    once = count[index.ravel()] == 1
    notes = () if once.all() else (f"{(~once).sum()} pixels left out: a point twice in an image",)
    return seen[once], of_image[once], notes


def _poses(path: Path, images: list[Image], time: Array, note: str) -> Poses:
    camera: IntArray
    camera, names = codes([image.camera for image in images])
    most = int(np.argmax(np.bincount(camera)))
    mine = np.flatnonzero(camera == most)
    pose = np.array([images[index].pose for index in mine])
    lines = np.array([images[index].line for index in mine])
    notes = (f"poses of the model in camera {names[most]}, in the model's scale", note)
    return poses_of(str(path), time[mine], pose[:, :4], pose[:, 4:], None, lines, notes)
