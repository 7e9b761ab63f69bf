"""Measured features in text files: their points, pixels and ranges."""

from dataclasses import replace
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.errors import UserError
from debrisest.parts.sources.from_files import FromFiles, one_run
from debrisest.parts.sources.views import views
from debrisest.roles import Positive
from debrisest.tracks.body_points import read_body_points
from debrisest.tracks.calibration import read_calibration
from debrisest.tracks.colmap import ColmapModel
from debrisest.tracks.match import match_geometry
from debrisest.tracks.report import Refusal
from debrisest.tracks.rigid import check_rigid
from debrisest.tracks.sheet import open_sheet
from debrisest.tracks.types import BodyPoints, Poses, Rig, Tracks


class _Found(NamedTuple):
    tracks: Tracks
    rig: Rig | None
    body: BodyPoints | None


class MeasuredTracks(FromFiles):
    """Features of one body over time, with its geometry and the cameras as far as they are known.

    Names of features are those of the geometry. What is not one rigid body is refused.
    """

    gives = (
        "measured_point", "point_sigma", "point_noise", "known_point_f", "measured_pixel",
        "pixel_noise", "focal_px", "rig_rotation", "rig_translation", "known_q_ic",
        "measured_range", "landmark", "landmark_range",
    )  # fmt: skip
    kind: Literal["tracks"]
    points: str | None = None
    """Known geometry, `feature,x_m,y_m,z_m`, in body axes of your own."""
    camera: str | list[str] | None = None
    """Calibration, which pixels need; of a stereo pair in one or two files."""
    noise_m: Positive | None = None
    """Standard deviation of each coordinate, where the file has no sigma."""
    noise_px: Positive | None = None
    """Standard deviation of each coordinate of a pixel; none: it is taken from the residuals."""

    @property
    def files(self) -> list[str]:
        """Return all files that this very part reads."""
        return [*super().files, *([self.points] if self.points else []), *self._cameras]

    @property
    def _cameras(self) -> list[str]:
        return [self.camera] if isinstance(self.camera, str) else self.camera or []

    def read(self, folder: Path) -> Data:
        """Return what is measured and known of one run."""
        return self.read_known(folder, None)

    def read_known(self, folder: Path, body: BodyPoints | None) -> Data:
        """Return the same with a geometry that is known from elsewhere, unless a file tells it."""
        found = self._found(folder)
        body, tracks, rig = found.body or body, found.tracks, found.rig
        if body is not None:
            tracks, body = match_geometry(tracks, body)
        q_ic, notes = self.attitude_of_chaser(folder, tracks.times)
        notes = (*tracks.notes, *(body.notes if body else ()), *_rigid(tracks, body), *notes)
        data: Data = {} if body is None else {"known_point_f": body.points}
        if tracks.points is not None:
            data |= self._points(tracks, q_ic)
        if tracks.pixels is not None and rig is not None:
            shown, told = views(tracks, rig, self.noise_px)
            data, notes = data | shown, notes + told
            data |= {} if q_ic is None else {"known_q_ic": q_ic[:, None]}
        elif tracks.pixels is not None:
            notes += (_no_camera(tracks),)
        ranges, told = _ranges(tracks)
        run = one_run(tracks.source, tracks.times, data | ranges, notes + told)
        observers = {"observer": np.array(["chaser"])} if "known_q_ic" in data else {}
        return run | observers | {"feature": np.array(tracks.features)}

    def _found(self, folder: Path) -> _Found:
        """Return tracks, cameras and geometry as the files have them."""
        found = self.measured(folder)
        if isinstance(found, Poses):
            raise UserError(f"{found.source}: this file holds poses, not tracks; use kind: poses")
        rig = read_calibration(*(folder / name for name in self._cameras)) if self.camera else None
        body = read_body_points(open_sheet(folder / self.points)) if self.points else None
        if isinstance(found, Tracks):
            return _Found(found, rig, body)
        tracks, own = _of_one_camera(found)
        return _Found(tracks, rig or own, body or found.body)

    def _points(self, tracks: Tracks, q_ic: Array | None) -> Data:
        """Return points and their noise, in inertial axes if the chaser's attitude is known."""
        assert tracks.points is not None
        points, sigma = tracks.points, tracks.point_sigma
        if sigma is None:
            sigma = np.full(points.shape, np.nan if self.noise_m is None else self.noise_m)
        if q_ic is not None:
            turn = quaternion.to_matrix(q_ic)[:, None]
            points = (turn @ points[..., None])[..., 0]
            sigma = np.sqrt((turn**2 @ sigma[..., None] ** 2)[..., 0])
        data: Data = {"measured_point": points, "point_sigma": sigma}
        known = sigma[np.isfinite(points)]
        if np.isfinite(known).all():
            data["point_noise"] = np.sqrt(np.mean(known**2))
        return data


def _rigid(tracks: Tracks, body: BodyPoints | None) -> list[str]:
    told = check_rigid(tracks, body)
    if refused := [sentence for sentence in told if isinstance(sentence, Refusal)]:
        raise UserError(refused)
    return told


def _no_camera(tracks: Tracks) -> str:
    said = "pixels need the camera's calibration"
    if tracks.points is None:
        raise UserError(f"{tracks.source}: {said}: give its file as camera")
    return f"pixels are left out: {said}, as camera"


def _of_one_camera(model: ColmapModel) -> tuple[Tracks, Rig]:
    """Return the pixels of the camera that sees most: how others are mounted is not told."""
    tracks = model.tracks
    assert tracks.pixels is not None
    seen = np.isfinite(tracks.pixels[..., 0])
    most = int(seen.sum(axis=(0, 2)).argmax())
    kept, name = seen[:, most].any(axis=-1), tracks.cameras[most]
    notes = tracks.notes
    if len(tracks.cameras) > 1:
        notes += (f"only images of camera {name}: how the others are mounted is not told",)
    notes += ("lengths are those of the model, metres in name only unless it was aligned",)
    own = replace(
        tracks, times=tracks.times[kept], lines=tracks.lines[kept], cameras=(name,),
        pixels=tracks.pixels[kept][:, [most]], notes=notes,
    )  # fmt: skip
    camera = next(camera for camera in model.cameras if camera.name == name)
    return own, Rig((camera,), np.eye(3)[None], np.zeros((1, 3)))


def _ranges(tracks: Tracks) -> tuple[Data, tuple[str, ...]]:
    """Return ranges to the target, or to the nearest feature of each epoch."""
    if tracks.ranges is None:
        return {}, ()
    if tracks.ranges.ndim == 1:
        return {"measured_range": tracks.ranges}, ()
    filled = np.where(np.isnan(tracks.ranges), np.inf, tracks.ranges)
    nearest, seen = filled.argmin(axis=-1), np.isfinite(filled).any(axis=-1)
    data: Data = {
        "landmark": np.where(seen, nearest, np.nan),
        "landmark_range": np.where(seen, filled.min(axis=-1), np.nan),
    }
    several = int((np.isfinite(filled).sum(axis=-1) > 1).sum())
    told = (f"{several} epochs have ranges to several features: the nearest counts",)
    return data, told if several else ()
