"""Structure from motion: where the cameras were about a body, and points of its surface.

The library COLMAP (Schoenberger and Frahm 2016) does it in a process of its own, in a folder that
a second attempt goes on from. A stereo rig of known baseline gives the scale; from one camera the
structure has a scale of its own.
"""

import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.counted import tell
from debrisest.reconstruction.silhouettes import Frames

CAMERAS = "camera"
RESULT = "structure.npz"
_INNER_PX = 8
"""From the outline, three sigma of a usual feature. A feature that reaches beyond the outline moves
with it, not with the surface: such ones make a body too small."""


class Rig(NamedTuple):
    """Pinhole cameras without distortion that stand still to each other."""

    matrix: Array
    """(camera, 3, 3), px; the middle of the first pixel is (0, 0)."""
    rotation: Array
    """(camera, 3, 3), first camera's axes to a camera's."""
    translation: Array
    """Origin of the first camera in a camera's axes (camera, 3), m."""


class Lens(NamedTuple):
    """Of a camera; distortion is what its images have beyond that of a pinhole camera."""

    matrix: Array
    """Camera matrix (3, 3), px."""
    distortion: Array
    """OpenCV's k1, k2, p1, p2, k3 (5,)."""
    focal_spread: float = 0.0
    """1-sigma of the focal length, of it; zero where it was given."""
    distortion_sigma: float = 0.0
    """1-sigma of k1; zero where it was given, or is taken to be zero."""


class How(NamedTuple):
    """What is done beyond what a calibrated camera with silhouettes needs."""

    calibrate: bool = False
    """Whether the focal length of the one camera follows from the images."""
    leave_out_still: bool = False
    """Whether features that stand still are left out, in the place of those off silhouettes."""


AS_GIVEN = How()


class Structure(NamedTuple):
    """Poses of the first camera about the body, and points, in axes r of their own."""

    rotation: Array
    """(time, 3, 3), axes r to the first camera's; NaN where a frame found no place."""
    translation: Array
    """Origin of the axes r in the first camera's (time, 3)."""
    points: Array
    """(point, 3)."""
    seen: BoolArray
    """Which frames see which point (time, point)."""
    scale_sigma: float
    """1-sigma of the scale, of it; infinite where nothing gives the scale."""
    reprojection_px: float
    """Mean distance of what is seen from where it should be."""
    lens: Lens | None = None
    """The camera's as the images tell it; None where it was given."""

    @property
    def registered(self) -> IntArray:
        """Return the frames that found a place."""
        return np.flatnonzero(np.isfinite(self.translation[:, 0]))

    def of(self, chosen: BoolArray) -> "Structure":
        """Return the structure with the chosen points (point,) only."""
        return self._replace(points=self.points[chosen], seen=self.seen[:, chosen])


def structure_from_motion(
    frames: Frames, masks: BoolArray, rig: Rig, folder: Path, how: How = AS_GIVEN
) -> Structure:
    """Return the structure of images (time, camera, row, column) without distortion.

    What is outside of ``masks``, or next to their outline, is left out. ``folder`` keeps what is
    done. Raises ValueError where the images do not hang together, and UserError without COLMAP.
    """
    result = folder / RESULT
    if not result.is_file():
        _prepare(frames, masks, rig, folder, how)
        _run(folder)
    with np.load(result) as found:
        if "failure" in found:
            raise ValueError(str(found["failure"]))
        sigma = float(found["focal_spread"]), float(found["distortion_sigma"])
        lens = Lens(found["matrix"], found["distortion"], *sigma)
        return Structure(
            rotation=found["rotation"],
            translation=found["translation"],
            points=found["points"],
            seen=found["seen"],
            scale_sigma=float(found["scale_sigma"]),
            reprojection_px=float(found["reprojection_px"]),
            lens=lens if lens.focal_spread > 0.0 else None,
        )


def image_name(camera: int, frame: int) -> str:
    """Return the name under which the process finds an image."""
    return f"{CAMERAS}{camera}/{frame:06d}.png"


def _prepare(frames: Frames, masks: BoolArray, rig: Rig, folder: Path, how: How = AS_GIVEN) -> None:
    """Write what the process reads, unless it is there."""
    from debrisest.files import put
    from debrisest.vision.libraries import vision_library

    cv2 = vision_library("cv2")
    vision_library("pycolmap")
    folder.mkdir(parents=True, exist_ok=True)
    around = np.ones((2 * _INNER_PX + 1, 2 * _INNER_PX + 1), np.uint8)
    for camera in range(frames.shape[1]):
        for frame in range(len(frames)):
            name = image_name(camera, frame)
            inner = cv2.erode(masks[frame, camera].astype(np.uint8) * 255, around)
            for path, image in (
                (folder / "images" / name, frames[frame, camera]),
                (folder / "masks" / f"{name}.png", inner),
            ):
                if not path.is_file():
                    put(path, cv2.imencode(".png", image)[1].tobytes())
    np.savez(folder / "rig.npz", frames=len(frames), **rig._asdict(), **how._asdict())


def _run(folder: Path) -> None:
    """Run the process and tell how far it is; ValueError if it ends without a result."""
    command = [sys.executable, "-m", "debrisest.reconstruction.structure_process", str(folder)]
    with (
        (folder / "log.txt").open("w") as log,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True) as process,
    ):
        try:
            for line in process.stdout or ():
                done, total, what = line.split(maxsplit=2)
                tell(what.strip(), int(done), int(total))
        finally:
            process.kill()
    if not (folder / RESULT).is_file():
        raise ValueError(f"structure from motion ended early; {folder / 'log.txt'} says why")
