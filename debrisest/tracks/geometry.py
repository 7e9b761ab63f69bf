"""Tracked points beside the known geometry of their target."""

import numpy as np

from debrisest.arrays import Array
from debrisest.tracks.mirror import is_mirrored
from debrisest.tracks.report import Refusal
from debrisest.tracks.types import BodyPoints, Tracks


def compare_geometry(tracks: Tracks, points: Array, body: BodyPoints) -> list[str]:
    """Sentences on what differs from the known geometry: names, handedness, scale.

    ``points (epoch, feature, 3)`` are those of the tracks, at some of their epochs.
    """
    unknown = [name for name in tracks.features if name not in body.features]
    told = []
    if unknown:
        known = ", ".join(body.features[:20])
        told.append(
            f"{tracks.source}: {', '.join(unknown)} not in {body.source}, which has {known}"
        )
    shared = [name for name in tracks.features if name in body.features]
    if len(shared) < 3:
        return told
    seen = points[:, [tracks.features.index(name) for name in shared]]
    model = body.points[[body.features.index(name) for name in shared]]
    if is_mirrored(np.broadcast_to(model, seen.shape), seen).mean() > 0.5:
        hint = "is an axis' sign changed, or are two columns swapped?"
        said = f"points match {body.source} as a mirror image only; {hint}"
        told.append(Refusal(f"{tracks.source}: {said}"))
    distance = np.linalg.norm(seen[:, :, None] - seen[:, None], axis=-1)
    known_distance = np.linalg.norm(model[:, None] - model[None], axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = distance / known_distance
    if (held := ratio[np.isfinite(ratio)]).size and not 0.8 < np.median(held) < 1.25:
        said = f"lengths are {np.median(held):.3g} times those of {body.source}"
        told.append(f"{tracks.source}: {said}; is the unit of one of them another one?")
    return told
