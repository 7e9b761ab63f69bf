"""A structure laid onto places of the camera that were measured otherwise: they give its scale."""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.rotation import nearest_rotation
from debrisest.reconstruction.structure import Structure

_OFF = 0.1
"""Of the places' extent: most that they may differ from those found."""


def laid_onto(structure: Structure, rotation: Array, translation: Array) -> Structure:
    """Return the structure in the axes in which ``rotation (time, 3, 3)`` and shifts are given.

    ``x_c = rotation x + translation (time, 3)``. The 1-sigma of the scale follows from what the
    places differ by. Raises ValueError where they are of no such structure, or all in line.
    """
    placed = structure.registered
    found, given = (
        -np.einsum("tji,tj->ti", turns[placed], shifts[placed])
        for turns, shifts in (
            (structure.rotation, structure.translation),
            (rotation, translation),
        )
    )
    turns = np.einsum("tji,tjk->ik", rotation[placed], structure.rotation[placed])
    turn = nearest_rotation(turns)[0]
    spread = [np.linalg.norm(each - each.mean(axis=0)) for each in (found, given)]
    scale = spread[1] / spread[0]
    shift = given.mean(axis=0) - scale * turn @ found.mean(axis=0)
    off = float(np.linalg.norm(scale * found @ turn.T + shift - given) / spread[1])
    if not off < _OFF:
        raise ValueError(
            f"the places of the cameras that were given differ from those found by {off:.0%} of "
            "their extent: are they of these images, as x_c = R x + t?"
        )
    turned = structure.rotation @ turn.T
    return structure._replace(
        rotation=turned,
        translation=scale * structure.translation - turned @ shift,
        points=scale * structure.points @ turn.T + shift,
        scale_sigma=off / np.sqrt(len(placed)),
    )
