"""Measured images: a folder or a video file, with the calibration of the cameras."""

from hashlib import sha256
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from debrisest.arrays import Array, Data
from debrisest.errors import UserError
from debrisest.files import content
from debrisest.roles import Positive, SourcePart
from debrisest.tracks.calibration import read_calibration
from debrisest.tracks.camera_places import read_places
from debrisest.tracks.types import Camera
from debrisest.tracks.write_calibration import camera_matrix
from debrisest.vision.focal_length import first_focal
from debrisest.vision.image_files import ImageSequence, read_images
from debrisest.vision.image_names import SUFFIXES, TIMES
from debrisest.vision.masks import read_masks

_COEFFICIENTS, _FEWEST = 5, 3
_PLACES = ".txt"


class MeasuredImages(SourcePart):
    """Images of one camera or of a stereo pair, one run; the paths count from the scenario's."""

    gives = (
        *("measured_image", "camera_matrix", "lens_distortion"),
        *("rig_rotation", "rig_translation", "focal_spread", "focal_source"),
    )
    libraries = ("cv2",)
    kind: Literal["image_files"]
    folder: str
    """A folder of images (of a pair: with `left` and `right` in it), or a video file."""
    camera: str | None = None
    """Calibration in OpenCV's YAML, which a pair needs; or a text file with the matrix, rotation
    and translation of each image of one camera (`name K R t`, or `name P`), or a folder with a file
    of such numbers for each image, which give the scale too. None: that of one camera follows from
    its images, with a start from EXIF or the field of view."""
    field_of_view_deg: Annotated[float, Field(gt=1, lt=170)] | None = None
    """Across the longer side of an image, where nothing is calibrated; none: EXIF, or 50."""
    widest_px: int | None = Field(None, ge=64)
    """Images with more columns are reduced to this many."""
    rate_hz: Positive | None = None
    """Frame rate of images that have no times; none: one each second."""
    every: int = Field(1, ge=1)
    """Take one image of so many."""
    masks: str | None = None
    """A folder of masks, white where the body is, one for each image, in the order of the numbers
    in their names; the folder of the images itself, where names of masks end in `mask`. None: the
    opacity of the images, or, where they have none, the body is told by what is behind it."""

    def read(self, folder: Path) -> Data:
        """Return images with their times, and what is known of the cameras."""
        images = read_images(
            folder / self.folder, self.widest_px, gaps=True, colours=True, every=self.every
        )
        times = self._times(images)
        if len(times) < _FEWEST:
            told = "one image" if len(times) == 1 else f"{len(times)} images"
            raise UserError(f"{images.source}: {told}; a body that turns needs {_FEWEST}, or more")
        seen = {"measured_chroma": images.chroma, "measured_mask": self._masks(folder, images)}
        return {
            "run": np.zeros(1),
            "time_s": times - times[0],
            "measured_image": images.frames[None],
            **{k: each[None] for k, each in seen.items() if each is not None},
            **self._cameras(folder, images),
        }

    def _masks(self, folder: Path, images: ImageSequence) -> NDArray[np.uint8] | None:
        if self.masks is None:
            return images.opacity
        return read_masks(folder / self.masks, images, self.widest_px, self.every)

    def _cameras(self, folder: Path, images: ImageSequence) -> Data:
        if self.camera is None:
            return self._uncalibrated(images)
        path = folder / self.camera
        if path.is_dir() or path.suffix.lower() == _PLACES:
            return self._placed(folder, images)
        return self._known(folder, images)

    def _placed(self, folder: Path, images: ImageSequence) -> Data:
        """Return the camera of a list of places, and these places."""
        path = folder / str(self.camera)
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

    def _known(self, folder: Path, images: ImageSequence) -> Data:
        """Return the cameras of a calibration."""
        path = folder / str(self.camera)
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

    def _uncalibrated(self, images: ImageSequence) -> Data:
        """Return a first camera, which the images are to correct."""
        if len(images.cameras) > 1:
            raise UserError(
                f"{images.source}: a stereo pair needs its calibration, from which its scale comes"
            )
        height, width = images.frames.shape[2:]
        path = Path(images.source).joinpath(*images.names[:1])
        first = first_focal(path, (width, height), self.field_of_view_deg)
        return _one_camera(first.matrix((width, height))) | {
            "focal_spread": np.array([first.spread]),
            "focal_source": np.array([first.source]),
        }

    def digest(self, folder: Path) -> str:
        """Return the SHA-256 of all images and of the calibration."""
        inside = [one for each in (self.folder, self.masks) if each for one in _in(folder / each)]
        used = [one for one in inside if one.suffix.lower() in SUFFIXES or one.name == TIMES]
        files = [*(used or inside), *(_in(folder / self.camera) if self.camera else [])]
        whole = sha256()
        for file in files:
            whole.update(sha256(content(file)).digest())
        return whole.hexdigest()

    def _times(self, images: ImageSequence) -> Array:
        number = self.every * np.arange(float(len(images.frames)))
        if self.rate_hz is not None:
            return number / self.rate_hz
        return number if images.times is None else images.times


def _in(path: Path) -> list[Path]:
    """Return a file, or those in a folder."""
    return sorted(path.rglob("*")) if path.is_dir() else [path]


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
