"""Structure from motion: where images of a turning body were taken, and points of its surface."""

import os
import shutil
from hashlib import sha256
from pathlib import Path
from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.problems.shape.model import body_in, pinhole_images
from debrisest.reconstruction.given_places import laid_onto
from debrisest.reconstruction.silhouettes import Frames
from debrisest.reconstruction.structure import How, Rig, Structure, structure_from_motion
from debrisest.roles import RecoveryPart

_SCALED = "the baseline of the cameras gives the scale"
_PLACED = "the places of the camera that were given tell the scale"
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
        *("found_camera_matrix", "found_lens_distortion", "found_focal_spread"),
        "found_distortion_spread",
    )
    version = 6
    libraries = ("cv2", "pycolmap")
    kind: Literal["structure_from_motion"]
    leave_out: Literal["outside_silhouettes", "still_features"] = "outside_silhouettes"
    """Features that are none of the body's: those outside of silhouettes, or those that stand still
    in the images; the latter asks for nothing but that the camera stands still too."""

    def recover(self, data: Data, clock: Clock) -> Data:
        """Return places (run, time), points (run, cloud_point) and how well they fit."""
        found = [self._structure(data, run) for run in range(len(data["run"]))]
        most = max(len(each.points) for each in found)
        return {
            "view_rotation": np.stack([each.rotation for each in found]),
            "view_translation": np.stack([each.translation for each in found]),
            "cloud_point_r": np.stack([padded(each.points, most) for each in found]),
            "cloud_seen": np.stack(
                [padded(each.seen.T.astype(np.float64), most).T for each in found]
            ),
            "scale_spread": np.array([each.scale_sigma for each in found]),
            "reprojection": np.array([each.reprojection_px for each in found]),
            **_cameras(data, found),
            "status": np.array([_scale(data)] * len(found)),
        }

    def _structure(self, data: Data, run: int) -> Structure:
        frames, rig = pinhole_images(data, run)
        still = self.leave_out == "still_features"
        spread = data.get("focal_spread", np.zeros(run + 1))[run]
        how = How(calibrate=bool(spread > 0.0), leave_out_still=still)
        anywhere = np.ones(frames.shape, dtype=np.bool_)
        masks = anywhere if still else body_in(frames, data, run)[0].masks
        folder = _folder(frames, rig, how)
        found = structure_from_motion(frames, masks, rig, folder, how)
        shutil.rmtree(folder, ignore_errors=True)
        if "given_rotation" not in data:
            return found
        return laid_onto(found, data["given_rotation"][run], data["given_translation"][run])

    def assess(self, data: Data) -> Data:
        """Return the share of frames that found a place."""
        return {"coverage": np.isfinite(data["view_translation"][..., 0]).mean(axis=-1)}


def _scale(data: Data) -> str:
    """Return where the scale comes from, in words."""
    if "given_rotation" in data:
        return _PLACED
    return _SCALED if data["camera_matrix"].shape[1] > 1 else _UNSCALED


def padded(values: Array, length: int) -> Array:
    """Return ``values (n, ...)`` with rows of NaN up to a length."""
    rest = np.full((length - len(values), *values.shape[1:]), np.nan)
    return np.concatenate([values, rest])


def _cameras(data: Data, found: list[Structure]) -> Data:
    """Return the cameras as given, but for what images tell of one that was not calibrated."""
    matrix, bent = data["camera_matrix"].copy(), data["lens_distortion"].copy()
    spread, bending = np.zeros((2, len(found)))
    for run, each in enumerate(found):
        if each.lens is not None:
            matrix[run, 0], bent[run, 0] = each.lens.matrix, each.lens.distortion
            spread[run], bending[run] = each.lens.focal_spread, each.lens.distortion_sigma
    return {
        "found_camera_matrix": matrix,
        "found_lens_distortion": bent,
        "found_focal_spread": spread,
        "found_distortion_spread": bending,
    }


def _folder(frames: Frames, rig: Rig, how: How) -> Path:
    """Return the folder of these very images in the user's cache."""
    digest = sha256(bytes([StructureFromMotion.version]) + np.ascontiguousarray(frames).tobytes())
    for values in (*rig, *how):
        digest.update(np.ascontiguousarray(values).tobytes())
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return cache / "debrisest" / "structure" / digest.hexdigest()[:20]
