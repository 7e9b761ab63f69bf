"""Measured images: a folder or a video file, with the calibration of the cameras."""

from hashlib import sha256
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data
from debrisest.errors import UserError
from debrisest.roles import Positive, SourcePart
from debrisest.tracks.calibration import read_calibration
from debrisest.tracks.types import Camera
from debrisest.vision.image_files import SUFFIXES, TIMES, ImageSequence, read_images

_COEFFICIENTS = 5


class MeasuredImages(SourcePart):
    """Images of one camera or of a stereo pair, one run; the paths count from the scenario's."""

    gives = (
        *("measured_image", "camera_matrix", "lens_distortion"),
        *("rig_rotation", "rig_translation"),
    )
    libraries = ("cv2",)
    kind: Literal["image_files"]
    folder: str
    """A folder of images (of a pair: with `left` and `right` in it), or a video file."""
    camera: str
    """Calibration in OpenCV's YAML."""
    rate_hz: Positive | None = None
    """Frame rate of images that have no times; none: one each second."""
    every: int = Field(1, ge=1)
    """Take one image of so many."""

    def read(self, folder: Path) -> Data:
        """Return images with their times, and what is known of the cameras."""
        images = read_images(folder / self.folder)
        rig = read_calibration(folder / self.camera)
        if len(rig.cameras) < len(images.cameras):
            raise UserError(f"{folder / self.camera}: one camera, but {images.source} has two")
        times = self._times(images)[:: self.every]
        if len(times) < 2:
            raise UserError(f"{images.source}: one image; a body that turns needs many")
        cameras = rig.cameras[: len(images.cameras)]
        return {
            "run": np.zeros(1),
            "time_s": times - times[0],
            "measured_image": images.frames[None, :: self.every],
            "camera_matrix": np.array([[_matrix(camera) for camera in cameras]]),
            "lens_distortion": np.array([[_lens(camera) for camera in cameras]]),
            "rig_rotation": rig.rotation[None, : len(cameras)],
            "rig_translation": rig.translation[None, : len(cameras)],
        }

    def digest(self, folder: Path) -> str:
        """Return the SHA-256 of all images and of the calibration."""
        path = folder / self.folder
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        used = [one for one in inside if one.suffix.lower() in SUFFIXES or one.name == TIMES]
        files = [*(used or inside), folder / self.camera]
        whole = sha256()
        for file in files:
            whole.update(sha256(file.read_bytes()).digest())
        return whole.hexdigest()

    def _times(self, images: ImageSequence) -> Array:
        if self.rate_hz is not None:
            return np.arange(len(images.frames)) / self.rate_hz
        return np.arange(float(len(images.frames))) if images.times is None else images.times


def _matrix(camera: Camera) -> Array:
    (fx, fy), (cx, cy) = camera.focal_px, camera.centre_px
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def _lens(camera: Camera) -> Array:
    """Return five coefficients; further ones, of rational lenses, are not taken."""
    if any(camera.distortion[_COEFFICIENTS:]):
        raise UserError(
            f"camera {camera.name}: lenses of more than k1, k2, p1, p2, k3 are not known"
        )
    told = np.zeros(_COEFFICIENTS)
    told[: len(camera.distortion)] = camera.distortion[:_COEFFICIENTS]
    return told
