"""What a mesh is made from: images, and where they were taken."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.reconstruction.silhouettes import Frames, Reading, readings, silhouettes
from debrisest.reconstruction.structure import Lens, Rig, Structure
from debrisest.reconstruction.undistorted import undistorted

ERROR_NAMES = (
    *("volume", "centre_x", "centre_y", "centre_z"),
    *(f"inertia_{axes}" for axes in ("xx", "yy", "zz", "xy", "xz", "yz")),
)


_HALF = 127
_GIVEN = "the masks that were given"


class ImagesOfBody(NamedTuple):
    """Images of one run without distortion, and where they were taken."""

    frames: Frames
    """(time, camera, row, column)."""
    readings: list[Reading]
    """Silhouettes: one reading, or several to choose from."""
    rig: Rig
    structure: Structure


class ShapeModel(NamedTuple):
    """The images of all runs, from which a filter makes meshes."""

    data: Data
    known_length: tuple[float, float] | None
    """The longest distance between two points of the body and its 1-sigma, m."""
    error_names: tuple[str, ...] = ERROR_NAMES

    def images(self, run: int, several: bool = False) -> ImagesOfBody:
        """Return what there is of a run, given by its place among the runs.

        Where several readings of the silhouettes are wanted there may be none: nothing tells them.
        """
        frames, rig = pinhole_images(self.data, run, "found_")
        try:
            read = body_in(frames, self.data, run, "found_")
        except ValueError:
            if not several:
                raise
            read = []
        return ImagesOfBody(frames, read, rig, structure_of(self.data, run))


def seen(data: Data, run: int) -> tuple[Frames, BoolArray, Rig]:
    """Return images without distortion, silhouettes, and cameras of a run."""
    frames, rig = pinhole_images(data, run)
    return frames, silhouettes(frames), rig


def pinhole_images(data: Data, run: int, which: str = "") -> tuple[Frames, Rig]:
    """Return images without distortion, and their cameras: as given, or the ones ``found_``."""
    matrix = data[f"{which}camera_matrix"][run]
    frames = data["measured_image"][run].astype(np.uint8)
    flat = undistorted(frames, matrix, data[f"{which}lens_distortion"][run])
    return flat, Rig(matrix, data["rig_rotation"][run], data["rig_translation"][run])


def body_in(frames: Frames, data: Data, run: int, which: str = "") -> list[Reading]:
    """Return where the body is in images without distortion: masks that are given, or readings.

    Raises ValueError where nothing tells it from what is behind it.
    """
    if (given := _pinhole(data, "measured_mask", run, which)) is not None:
        return [Reading(given > _HALF, _GIVEN, given=True)]
    return readings(frames, _pinhole(data, "measured_chroma", run, which))


def _pinhole(data: Data, name: str, run: int, which: str) -> Frames | None:
    """Return images of a kind without distortion, if there are any."""
    if name not in data:
        return None
    lens = (data[f"{which}{lens}"][run] for lens in ("camera_matrix", "lens_distortion"))
    return undistorted(data[name][run].astype(np.uint8), *lens)


def structure_of(data: Data, run: int) -> Structure:
    """Return the stored structure of a run."""
    points = data["cloud_point_r"][run]
    lens = Lens(
        matrix=data["found_camera_matrix"][run, 0],
        distortion=data["found_lens_distortion"][run, 0],
        focal_spread=float(data["found_focal_spread"][run]),
    )
    there: Array = np.isfinite(points[:, 0])
    return Structure(
        rotation=data["view_rotation"][run],
        translation=data["view_translation"][run],
        points=points[there],
        seen=data["cloud_seen"][run][:, there] == 1.0,
        scale_sigma=float(data["scale_spread"][run]),
        reprojection_px=float(data["reprojection"][run]),
        lens=lens if lens.focal_spread > 0.0 else None,
    )
