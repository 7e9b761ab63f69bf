"""A target that differs from run to run: a homogeneous box with points anywhere in it."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.roles import Limits, Positive, SimulationPart


class RandomBox(SimulationPart):
    """Half sides, and points inside, drawn for each run; the origin is the centre of mass.

    The surface at a point is parallel to the face of the box that it is nearest to.
    """

    truths = ("true_point_b", "true_normal_b", "true_inertia_b")
    kind: Literal["random_box"]
    count: Annotated[int, Field(ge=3)]
    """Number of points."""
    half_side_m: Limits[Positive]
    """Limits of the half sides, each drawn evenly between them."""
    mass_kg: Positive = 500.0
    """Mass; it only scales the inertia."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return points, normals and inertia of each run's box."""
        low, high = self.half_side_m
        half = low + (high - low) * draws.uniform(Stream.TRUTH, (3,))
        relative = 2 * draws.uniform(Stream.TRUTH, (self.count, 3)) - 1
        nearest = np.eye(3)[np.abs(relative).argmax(-1)]
        return {
            "feature": np.array([f"p{i + 1}" for i in range(self.count)]),
            "true_point_b": half[:, None] * relative,
            "true_normal_b": nearest * np.where(relative < 0, -1.0, 1.0),
            "true_inertia_b": self.mass_kg * _box_moments(half)[..., None] * np.eye(3),
        }


def _box_moments(half: Array) -> Array:
    """Moments (run, 3) of homogeneous boxes of unit mass with half sides (run, 3)."""
    square = half**2
    return np.asarray((square.sum(-1, keepdims=True) - square) / 3)
