"""A target that differs from run to run: features anywhere in a box."""

from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.dynamics import inertia_ratios
from debrisest.roles import Positive, SimulationPart


def _possible_ratios(k: list[float]) -> list[float]:
    with np.errstate(over="ignore", invalid="ignore"):
        slope = np.abs(inertia_ratios.slopes(np.array(k))).max()
    if not slope < 1:
        raise ValueError(
            "no body has these inertia ratios, ln(Ix/Iy) and ln(Iy/Iz): one principal moment "
            "would exceed the sum of the two others (triangle inequality)"
        )
    return k


InertiaRatios = Annotated[
    list[float], Field(min_length=2, max_length=2), AfterValidator(_possible_ratios)
]


class RandomPoints(SimulationPart):
    """Features spread evenly over a cube about the centre of mass, along principal axes.

    The surface at a feature is parallel to the face of the cube that the feature is nearest to: a
    boxy body with panels that are set back.
    """

    version = 2
    truths = ("true_point_b", "true_normal_b", "true_inertia_ratio", "true_inertia_b")
    kind: Literal["random_points"]
    count: Annotated[int, Field(ge=3)]
    """Number of features."""
    half_size_m: Positive
    """Half the edge of the cube."""
    inertia_ratios: InertiaRatios
    """Logarithms ln(Ix/Iy) and ln(Iy/Iz); no moment may exceed the sum of the others."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return points drawn for each run, their normals, and the inertia, scaled to Iy = 1."""
        drawn = draws.uniform(Stream.TRUTH, (self.count, 3))
        ratios = np.tile(self.inertia_ratios, (len(drawn), 1))
        moments = inertia_ratios.moments(ratios)
        points = self.half_size_m * (2 * drawn - 1)
        return {
            "feature": np.array([f"p{i + 1}" for i in range(self.count)]),
            "true_point_b": points,
            "true_normal_b": _normals_of_nearest_faces(points),
            "true_inertia_ratio": ratios,
            "true_inertia_b": moments[..., None] * np.eye(3),
        }


def _normals_of_nearest_faces(points: Array) -> Array:
    """Outward unit normals (..., 3) of the faces of a cube about the origin."""
    nearest = np.abs(points).argmax(-1)
    return np.asarray(np.eye(3)[nearest] * np.where(points < 0, -1.0, 1.0))
