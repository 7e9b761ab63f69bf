"""The cameras of measured images: calibrated, with places that are given, or not known yet."""

from pathlib import Path

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.errors import UserError
from debrisest.tracks.calibration import read_calibration
from debrisest.tracks.camera_places import read_places
from debrisest.tracks.types import Camera
from debrisest.tracks.write_calibration import camera_matrix
from debrisest.vision.focal_length import first_focal
from debrisest.vision.image_files import ImageSequence

_COEFFICIENTS = 5
_PLACES = ".txt"


def given_cameras(path: Path, images: ImageSequence) -> Data:
    """Return the cameras of a calibration, or the one of places that are given, with these.

    Raises `UserError` for files that are no such, or not of these images.
    """
    placed = path.is_dir() or path.suffix.lower() == _PLACES
    return _placed(path, images) if placed else _known(path, images)


def first_camera(images: ImageSequence, field_of_view_deg: float | None) -> Data:
    """Return a camera to begin with, which the images are to correct.

    Raises `UserError` for a pair.
    """
    if len(images.cameras) > 1:
        raise UserError(
            f"{images.source}: a stereo pair needs its calibration, from which its scale comes"
        )
    height, width = images.frames.shape[2:]
    path = Path(images.source).joinpath(*images.names[:1])
    first = first_focal(path, (width, height), field_of_view_deg)
    return _one_camera(first.matrix((width, height))) | {
        "focal_spread": np.array([first.spread]),
        "focal_source": np.array([first.source]),
    }


def _placed(path: Path, images: ImageSequence) -> Data:
    """Return the camera of a list of places, and these places."""
    if len(images.cameras) > 1 or not images.names:
        raise UserError(f"{path}: places are of the images of one camera, in a folder")
    found = read_places(path, images.names)
    matrix = found.matrix
    focal, centre = (matrix[0, 0], matrix[1, 1]), (matrix[0, 2], matrix[1, 2])
    return _one_camera(_matrix(Camera("camera", focal, centre), images.reduced)) | {
        "given_rotation": found.rotation[None],
        "given_translation": found.translation[None],
        "focal_spread": np.zeros(1),
        "focal_source": np.array([f"the places {path.name}"]),
    }


def _known(path: Path, images: ImageSequence) -> Data:
    """Return the cameras of a calibration."""
    rig = read_calibration(path)
    if len(rig.cameras) < len(images.cameras):
        raise UserError(f"{path}: one camera, but {images.source} has two")
    cameras = rig.cameras[: len(images.cameras)]
    for camera in cameras:
        _check_size(path, camera, images)
    return {
        "camera_matrix": np.array([[_matrix(camera, images.reduced) for camera in cameras]]),
        "lens_distortion": np.array([[_lens(camera) for camera in cameras]]),
        "rig_rotation": rig.rotation[None, : len(cameras)],
        "rig_translation": rig.translation[None, : len(cameras)],
        "focal_spread": np.zeros(1),
        "focal_source": np.array([f"the calibration {path.name}"]),
    }


def _one_camera(matrix: Array) -> Data:
    """Return a camera (3, 3) without distortion that stands alone."""
    return {
        "camera_matrix": matrix[None, None],
        "lens_distortion": np.zeros((1, 1, _COEFFICIENTS)),
        "rig_rotation": np.eye(3)[None, None],
        "rig_translation": np.zeros((1, 1, 3)),
    }


def _matrix(camera: Camera, reduced: float) -> Array:
    """Return the matrix (3, 3) of a camera whose images were reduced to a part of their size."""
    matrix = reduced * camera_matrix(camera)
    matrix[:2, 2] += 0.5 * (reduced - 1.0)
    matrix[2, 2] = 1.0
    return np.asarray(matrix)


def _check_size(path: Path, camera: Camera, images: ImageSequence) -> None:
    """Raise UserError for a calibration of images of another size."""
    width = round(images.frames.shape[3] / images.reduced)
    if camera.size is not None and camera.size[0] != width:
        raise UserError(
            f"{path}: of images that are {camera.size[0]} pixels wide, but {images.source} has "
            f"{width}: a calibration holds for the size that it was made with"
        )


def _lens(camera: Camera) -> Array:
    """Return five coefficients; further ones, of rational lenses, are not taken."""
    if any(camera.distortion[_COEFFICIENTS:]):
        raise UserError(
            f"camera {camera.name}: lenses of more than k1, k2, p1, p2, k3 are not known"
        )
    told = np.zeros(_COEFFICIENTS)
    told[: len(camera.distortion)] = camera.distortion[:_COEFFICIENTS]
    return told
