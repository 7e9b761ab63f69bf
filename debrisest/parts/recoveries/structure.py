"""Structure from motion: where images of a turning body were taken, and points of its surface."""

import os
import shutil
from hashlib import sha256
from pathlib import Path
from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.problems.shape.model import seen
from debrisest.reconstruction.silhouettes import Frames
from debrisest.reconstruction.structure import Rig, Structure, structure_from_motion
from debrisest.roles import RecoveryPart

_SCALED = "the baseline of the cameras gives the scale"
_UNSCALED = "one camera gives no scale: only ratios are told, unless a length is known"


class StructureFromMotion(RecoveryPart):
    """Places of the first camera about the body and a cloud, in axes r of their own.

    What is done is kept in a folder of the user's cache until the structure is complete, so that a
    run that is killed goes on from there.
    """

    needs = (
        *("measured_image", "camera_matrix", "lens_distortion"),
        *("rig_rotation", "rig_translation"),
    )
    gives = (
        *("view_rotation", "view_translation", "cloud_point_r", "cloud_seen"),
        *("scale_spread", "reprojection"),
    )
    version = 2
    libraries = ("cv2", "pycolmap")
    kind: Literal["structure_from_motion"]

    def recover(self, data: Data, clock: Clock) -> Data:
        """Return places (run, time), points (run, cloud_point) and how well they fit."""
        found = [_structure(data, run) for run in range(len(data["run"]))]
        most = max(len(each.points) for each in found)
        scaled = data["camera_matrix"].shape[1] > 1
        return {
            "view_rotation": np.stack([each.rotation for each in found]),
            "view_translation": np.stack([each.translation for each in found]),
            "cloud_point_r": np.stack([padded(each.points, most) for each in found]),
            "cloud_seen": np.stack(
                [padded(each.seen.T.astype(np.float64), most).T for each in found]
            ),
            "scale_spread": np.array([each.scale_sigma for each in found]),
            "reprojection": np.array([each.reprojection_px for each in found]),
            "status": np.array([_SCALED if scaled else _UNSCALED] * len(found)),
        }

    def assess(self, data: Data) -> Data:
        """Return the share of frames that found a place."""
        return {"coverage": np.isfinite(data["view_translation"][..., 0]).mean(axis=-1)}


def padded(values: Array, length: int) -> Array:
    """Return ``values (n, ...)`` with rows of NaN up to a length."""
    rest = np.full((length - len(values), *values.shape[1:]), np.nan)
    return np.concatenate([values, rest])


def _structure(data: Data, run: int) -> Structure:
    frames, masks, rig = seen(data, run)
    folder = _folder(frames, rig)
    found = structure_from_motion(frames, masks, rig, folder)
    shutil.rmtree(folder, ignore_errors=True)
    return found


def _folder(frames: Frames, rig: Rig) -> Path:
    """Return the folder of these very images in the user's cache."""
    digest = sha256(bytes([StructureFromMotion.version]) + np.ascontiguousarray(frames).tobytes())
    for values in rig:
        digest.update(np.ascontiguousarray(values).tobytes())
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return cache / "debrisest" / "structure" / digest.hexdigest()[:20]
