"""Which silhouettes a body has: of several readings, those that go with its cloud."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from debrisest.arrays import BoolArray
from debrisest.reconstruction.outer import Outer
from debrisest.reconstruction.outlines import main_part, outlines
from debrisest.reconstruction.silhouettes import Frames, Reading
from debrisest.reconstruction.structure import Rig, Structure

Outline = Literal["silhouettes", "either"]
_AGREED, _AGREED_GIVEN = 0.8, 0.03
"""Share of the structure's points that silhouettes must hold: most, and if they were given some,
since a table that turns with the body, or a room about it, has points too."""
_SCENE = 0.1
"""Share of the points about the camera beyond which they are no body's."""
_BY_CLOUD = "the hull of the cloud, since silhouettes do not tell the body: hollows fill"


def outlined(
    frames: Frames,
    readings: Sequence[Reading],
    rig: Rig,
    structure: Structure,
    outline: Outline,
) -> tuple[Reading, BoolArray]:
    """Return silhouettes, and which points (point,) they hold.

    Of several readings (none: nothing tells them) that which overlaps most with the cloud, or the
    hull of the cloud where none holds most of it; masks that were given in any case. Raises
    ValueError where those hold too few points.
    """
    held = [
        Outer(one.masks[:, 0], rig.matrix[0], structure).holds(structure.points) for one in readings
    ]
    if any(one.given for one in readings):
        return _given(readings[0], held[0])
    if outline == "silhouettes":
        if held[0].mean() < _AGREED:
            raise ValueError(
                "the structure does not agree with the silhouettes, which hold "
                f"{held[0].mean():.0%} of its points: images were placed wrongly; take more of "
                "them, or larger ones"
            )
        return readings[0], held[0]
    if (around := _around(structure)) > _SCENE:
        raise ValueError(
            f"the camera went about a scene, {around:.0%} of whose points are around it: nothing "
            "tells what of it is the body; give masks (--masks), or images that are cut out"
        )
    part = main_part(structure)
    drawn = outlines(structure.of(part), rig.matrix[0], frames.shape[2:])
    agree = [place for place, each in enumerate(held) if each.mean() >= _AGREED]
    if not agree:
        return Reading(np.repeat(drawn[:, None], frames.shape[1], axis=1), _BY_CLOUD), part
    best = max(agree, key=lambda place: _overlap(readings[place].masks[:, 0], drawn))
    return readings[best], held[best]


def _around(structure: Structure) -> float:
    """Return the share of points that lie behind the camera in an image: none of a body's do."""
    placed = structure.registered
    ahead = structure.rotation[placed, 2] @ structure.points.T
    behind = ahead + structure.translation[placed, 2, None] < 0.0
    return float(behind.any(axis=0).mean())


def _given(reading: Reading, held: BoolArray) -> tuple[Reading, BoolArray]:
    """Return masks that were given with the points they hold, or raise ValueError for too few."""
    if held.mean() < _AGREED_GIVEN:
        raise ValueError(
            f"the masks hold {held.mean():.0%} of the structure's points: are they of these "
            "images, in their order?"
        )
    return reading, held


def _overlap(masks: BoolArray, drawn: BoolArray) -> float:
    """Return the share of what either of two outlines holds that both do, where one is drawn."""
    there = drawn.any(axis=(1, 2))
    return float((masks & drawn)[there].sum() / (masks | drawn)[there].sum())
