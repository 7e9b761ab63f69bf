"""From image sequences of calibrated cameras to tracks."""

from collections import Counter
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.errors import UserError
from debrisest.tracks.types import Camera, Rig, Tracks
from debrisest.tracks.write_calibration import camera_matrix
from debrisest.vision.camera import PinholeImage
from debrisest.vision.image_files import ImageSequence
from debrisest.vision.stereo_pair import StereoPair, rectified
from debrisest.vision.stereo_tracker import Followed, StereoTracker, follow_all

SHORTEST = 3
"""Frames of a track that is kept."""
_FEWEST = 4
"""Tracks of which a motion can be found."""


class Tracked(NamedTuple):
    """What was followed, how well, and what was left out and why."""

    tracks: Tracks
    left_out: Counter[str]
    """Reasons: how many points."""
    known_again: int
    """Points that were lost and known again."""
    noise_px: float
    """1-sigma of a pixel's coordinate, from how the points fit to the body's motion."""


def cameras_of(rig: Rig, images: ImageSequence) -> list[PinholeImage]:
    """Return the cameras of a rig as the numerics have them; raise UserError if they do not fit."""
    height, width = images.frames.shape[-2:]
    if len(rig.cameras) != len(images.cameras):
        raise UserError(
            f"{images.source}: images of {len(images.cameras)} cameras, but the calibration has "
            f"{len(rig.cameras)}"
        )
    for camera in rig.cameras:
        if camera.size not in (None, (width, height)):
            raise UserError(
                f"{images.source}: images of {width} x {height} pixels, but the calibration is of "
                f"{camera.size[0]} x {camera.size[1]}"  # type: ignore[index]
            )
    return [
        PinholeImage((width, height), camera_matrix(camera), _five(camera), turn, shift)
        for camera, turn, shift in zip(rig.cameras, rig.rotation, rig.translation)
    ]


def stereo_tracks(
    images: ImageSequence, rig: Rig, times: Array, each: Callable[[int], None]
) -> Tracked:
    """Return points, m, in the axes of the first camera, with their sigma.

    ``each`` is told the number of every frame that is done. Raises `UserError` where too little is
    found to be followed.
    """
    turned = rectified(*cameras_of(rig, images))
    tracker = StereoTracker(turned, seed=0)
    follow_all(tracker, images.frames, each)
    noise = _noise(tracker)
    kept, index = _long_enough(tracker.found, images.source)
    points, sigma = (np.full((len(times), len(kept), 3), np.nan) for _ in range(2))
    for epoch, found in enumerate(tracker.found):
        which = index[found.numbers]
        seen, spread = _in_first_camera(turned.pair, turned.rotation, found.pixels, noise)
        points[epoch, which[which >= 0]] = seen[which >= 0]
        sigma[epoch, which[which >= 0]] = spread[which >= 0]
    names = tuple(f"f{number + 1}" for number in range(len(kept)))
    lines = np.arange(len(times))
    tracks = Tracks(images.source, times, names, lines, points, sigma)
    left_out = tracker.counts + Counter({f"seen in fewer than {SHORTEST} frames": (index < 0).sum()})
    return Tracked(tracks, left_out, tracker.known_again, noise)


def _five(camera: Camera) -> Array:
    """Return the five coefficients of a lens; raise UserError for a lens with more."""
    if any(camera.distortion[5:]):
        raise UserError(f"camera {camera.name}: a lens with more than 5 distortion coefficients")
    return np.array([*camera.distortion, *[0.0] * 5])[:5]


def _in_first_camera(
    pair: StereoPair, rotation: Array, pixels: Array, noise: float
) -> tuple[Array, Array]:
    """Return points (n, 3), m, and their sigma per axis, first camera's axes."""
    seen, cofactor = pair.points(pixels)
    covariance = noise**2 * rotation.T @ cofactor @ rotation
    return seen @ rotation, np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))


def _long_enough(found: list[Followed], source: str) -> tuple[IntArray, IntArray]:
    """Return the numbers of the tracks that are kept, and the new number of each (-1: none)."""
    numbers = np.concatenate([one.numbers for one in found])
    frames = np.bincount(numbers)
    kept = np.flatnonzero(frames >= SHORTEST)
    if len(kept) < _FEWEST:
        raise UserError(
            f"{source}: nothing can be followed: {len(kept)} points in {SHORTEST} frames or more; "
            "the body must be in all images, sharp, and turn less than about 15 deg from one to "
            "the next"
        )
    index = np.full(len(frames), -1)
    index[kept] = np.arange(len(kept))
    return kept, index


def _noise(tracker: StereoTracker) -> float:
    """Return the sigma of a coordinate: of residuals to the map, without what is far off."""
    residuals = [
        found.pixels - tracker.pair.project(pose.of(tracker.map.points[found.numbers]))
        for found, pose in zip(tracker.found, tracker.poses)
    ]
    every = np.concatenate([one.ravel() for one in residuals])
    return float(1.4826 * np.median(np.abs(every))) if every.size else np.nan
