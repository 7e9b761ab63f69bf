"""From what was followed frame by frame to what the whole sequence shows of each point."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import BoolArray, IntArray
from debrisest.vision.bundle import Bundle, Sightings, adjusted, noise_of
from debrisest.vision.patches import found_again
from debrisest.vision.rigid_pose import RigidPose
from debrisest.vision.stereo_pair import StereoPair
from debrisest.vision.stereo_tracker import StereoTracker

SHORTEST = 5
"""Frames of a track that is kept."""
_ROUNDS = 2
_OFF = 5.0
"""Times the noise by which a wrong sighting is off."""


class Refined(NamedTuple):
    """Points of a body that are seen in enough images."""

    bundle: Bundle
    sightings: Sightings
    noise_px: float
    """1-sigma of a pixel's coordinate, from residuals."""
    off: int
    """Sightings that were left out: off the motion of the others."""


def refined(tracker: StereoTracker) -> Refined | None:
    """Return what a tracker found, aligned and adjusted as a whole; None if it is too little."""
    pair, started = tracker.pair, _started(tracker)
    if started is None:
        return None
    bundle, sightings = started
    bundle, sightings, _ = _without_off(pair, adjusted(pair, bundle, sightings), sightings)
    off = 0
    for _ in range(_ROUNDS):
        again = _long_enough(found_again(tracker.images, pair, bundle, sightings))
        if not len(again.epoch):
            return None
        bundle, again = _numbered(bundle, again)
        bundle, sightings, off = _without_off(pair, adjusted(pair, bundle, again), again)
    return Refined(bundle, sightings, noise_of(pair, bundle, sightings), off)


def _started(tracker: StereoTracker) -> tuple[Bundle, Sightings] | None:
    """Return the tracker's map, poses and pixels of the points that are seen long enough."""
    counts = [len(found.numbers) for found in tracker.found]
    every = Sightings(
        np.repeat(np.arange(len(counts)), counts),
        np.concatenate([found.numbers for found in tracker.found]),
        np.concatenate([found.pixels for found in tracker.found]),
    )
    kept = _long_enough(every)
    if not len(kept.epoch):
        return None
    poses: list[RigidPose] = tracker.poses
    turns = np.stack([pose.rotation for pose in poses])
    shifts = np.stack([pose.translation for pose in poses])
    return _numbered(Bundle(turns, shifts, tracker.map.points), kept)


def _without_off(
    pair: StereoPair, bundle: Bundle, sightings: Sightings
) -> tuple[Bundle, Sightings, int]:
    """Return the bundle without sightings that are off, and how many these are."""
    residual = np.linalg.norm(bundle.residuals(pair, sightings), axis=-1).max(axis=-1)
    good = residual < _OFF * noise_of(pair, bundle, sightings)
    kept = _long_enough(_some(sightings, good))
    if not len(kept.epoch):
        return bundle, sightings, 0
    bundle, kept = _numbered(bundle, kept)
    return adjusted(pair, bundle, kept), kept, int((~good).sum())


def _some(sightings: Sightings, which: BoolArray) -> Sightings:
    return Sightings(sightings.epoch[which], sightings.point[which], sightings.pixels[which])


def _long_enough(sightings: Sightings) -> Sightings:
    seen: IntArray = np.bincount(sightings.point)
    return _some(sightings, seen[sightings.point] >= SHORTEST)


def _numbered(bundle: Bundle, sightings: Sightings) -> tuple[Bundle, Sightings]:
    """Return both with only those points that are seen."""
    points, number = np.unique(sightings.point, return_inverse=True)
    return bundle._replace(points=bundle.points[points]), sightings._replace(point=number)
