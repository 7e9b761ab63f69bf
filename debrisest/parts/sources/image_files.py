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
from debrisest.parts.sources.image_cameras import first_camera, given_cameras
from debrisest.roles import Positive, SourcePart
from debrisest.vision.image_files import ImageSequence, read_images
from debrisest.vision.image_names import SUFFIXES, TIMES
from debrisest.vision.masks import read_masks

_FEWEST = 3


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
            return first_camera(images, self.field_of_view_deg)
        return given_cameras(folder / self.camera, images)

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
    return sorted(filter(Path.is_file, path.rglob("*"))) if path.is_dir() else [path]
