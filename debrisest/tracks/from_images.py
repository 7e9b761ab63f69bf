"""From image sequences of calibrated cameras to tracks."""

from collections import Counter
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.counted import counted
from debrisest.errors import UserError
from debrisest.reconstruction.silhouettes import before_backdrop
from debrisest.tracks.types import Camera, Rig, Tracks
from debrisest.tracks.write_calibration import camera_matrix
from debrisest.vision.camera import PinholeImage
from debrisest.vision.image_files import ImageSequence
from debrisest.vision.pixel_tracker import PixelTracker
from debrisest.vision.refined import SHORTEST, refined
from debrisest.vision.stereo_pair import StereoPair, rectified
from debrisest.vision.stereo_tracker import StereoTracker

_HALF = 127
_FEWEST = 4
"""Tracks of which a motion can be found."""


class Tracked(NamedTuple):
    """What was followed, how well, and what was left out and why."""

    tracks: Tracks
    shown: Array
    """Pixels (epoch, camera, feature, 2) in the images as they are, for pictures."""
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
                f"{camera.size[0]} x {camera.size[1]}"
            )
    return [
        PinholeImage((width, height), camera_matrix(camera), _five(camera), turn, shift)
        for camera, turn, shift in zip(rig.cameras, rig.rotation, rig.translation)
    ]


def stereo_tracks(images: ImageSequence, rig: Rig, times: Array) -> Tracked:
    """Return points, m, in the axes of the first camera, with their sigma.

    Raises `UserError` where too little is found to be followed.
    """
    turned = rectified(*cameras_of(rig, images))
    tracker = StereoTracker(turned, seed=0, body=_body(images))
    for number in counted(range(len(times)), "images"):
        tracker.take(images.frames, number)
    found = refined(tracker)
    if found is None or len(found.bundle.points) < _FEWEST:
        raise UserError(_nothing(images))
    epoch, point, pixels = found.sightings
    shape = (len(times), len(found.bundle.points))
    points, sigma = (np.full((*shape, 3), np.nan) for _ in range(2))
    points[epoch, point], sigma[epoch, point] = _in_first_camera(
        turned.pair, turned.rotation, pixels, found.noise_px
    )
    shown = np.full((shape[0], 1, shape[1], 2), np.nan)
    shown[epoch, 0, point] = cameras_of(rig, images)[0].project(points[epoch, point])
    lost = len(tracker.map.points) - shape[1]
    left_out = tracker.counts + Counter(
        {f"seen in fewer than {SHORTEST} frames": lost, "off the motion of the others": found.off}
    )
    tracks = Tracks(images.source, times, _names(shape[1]), np.arange(len(times)), points, sigma)
    return Tracked(tracks, shown, left_out, tracker.known_again, found.noise_px)


def pixel_tracks(images: ImageSequence, times: Array) -> Tracked:
    """Return pixels of one camera, as its lens shows them, of the images before they were reduced.

    Points that were lost are not known again: that takes a map of the body. Raises `UserError`
    where too little is found.
    """
    tracker = PixelTracker(_body(images))
    for epoch in counted(range(len(times)), "images"):
        tracker.take(images.frames[:, 0], epoch)
    length = np.bincount(np.concatenate([found.numbers for found in tracker.found]))
    kept = np.flatnonzero(length >= SHORTEST)
    if len(kept) < _FEWEST:
        raise UserError(_nothing(images))
    pixels = np.full((len(times), 1, len(length), 2), np.nan)
    for epoch, found in enumerate(tracker.found):
        pixels[epoch, 0, found.numbers] = found.pixels
    pixels = pixels[:, :, kept]
    lost = len(length) - len(kept)
    left_out = tracker.counts + Counter({f"seen in fewer than {SHORTEST} frames": lost})
    tracks = Tracks(
        images.source, times, _names(len(kept)), np.arange(len(times)),
        cameras=images.cameras, pixels=(pixels + 0.5) / images.reduced - 0.5,
    )  # fmt: skip
    return Tracked(tracks, pixels, left_out, 0, np.nan)


def _body(images: ImageSequence) -> BoolArray | None:
    """Return where the first camera shows the body (time, row, column): cut out, or before colours.

    None where there is no coloured backdrop either: what moves is the body then.
    """
    if images.opacity is not None:
        return np.asarray(images.opacity[:, 0] > _HALF)
    masks = before_backdrop(images.frames, images.chroma)
    return None if masks is None else masks[:, 0]


def _names(count: int) -> tuple[str, ...]:
    return tuple(f"f{number + 1}" for number in range(count))


def _nothing(images: ImageSequence) -> str:
    return (
        f"{images.source}: nothing can be followed: fewer than {_FEWEST} points in {SHORTEST} "
        "frames or more; the body must be in all images, sharp, and turn less than about 15 deg "
        "from one to the next"
    )


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
