"""A target that differs from run to run: inertia of several kinds, points on a box."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.attitude.points import features_frame
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.roles import Limits, Positive, SimulationPart

Share = Annotated[float, Field(ge=0, le=1)]
_SECOND_MOMENTS = (0.05, 1.0)
_SYMMETRY = (1e-3, 1e-1)
_ROUNDNESS = 1e-3


class RandomRigidBody(SimulationPart):
    """Inertia from random second moments, in random axes; points on the faces of a random box.

    Some bodies are nearly symmetric (two second moments differ by 0.1 to 10 %), some exactly, some
    nearly spherical (by 0.1 %). Box and inertia have nothing to do with each other.
    """

    truths = ("true_point_b", "true_normal_b", "true_inertia_b")
    knows = ("known_point_f",)
    kind: Literal["random_rigid_body"]
    count: Limits[Annotated[int, Field(ge=3)]]
    """Limits of the number of points."""
    half_side_m: Limits[Positive]
    """Limits of the half sides of the box."""
    nearly_symmetric_share: Share = 0.2
    """Share of the runs with a body that is nearly symmetric."""
    axisymmetric_share: Share = 0.15
    """Share of the runs with two equal moments."""
    nearly_spherical_share: Share = 0.05
    """Share of the runs with three almost equal moments."""

    @model_validator(mode="after")
    def _shares_of_a_whole(self) -> "RandomRigidBody":
        if sum(self._shares) > 1.0 + 1e-9:
            raise ValueError(f"the shares add up to {sum(self._shares):g}; at most 1 is allowed")
        return self

    @property
    def _shares(self) -> tuple[float, float, float]:
        return self.nearly_symmetric_share, self.axisymmetric_share, self.nearly_spherical_share

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return points, normals and inertia of each run's body; a spare point faces nobody."""
        points, normals = self._points(draws)
        frame = features_frame(points)
        return {
            "feature": np.array([f"p{i + 1}" for i in range(self.count[1])]),
            "known_point_f": (points - points[:, :1]) @ frame,
            "true_point_b": points,
            "true_normal_b": normals,
            "true_inertia_b": self._inertia(draws),
        }

    def _inertia(self, draws: Draws) -> Array:
        chance = draws.uniform(Stream.TRUTH, (1,))
        x, y, z = np.moveaxis(_between(_SECOND_MOMENTS, draws.uniform(Stream.TRUTH, (3,))), -1, 0)
        near = x * (1.0 + _log_between(_SYMMETRY, draws.uniform(Stream.TRUTH, (1,))[:, 0]))
        round_ = 1.0 + _ROUNDNESS * draws.normal(Stream.TRUTH, (3,))
        kind = np.sum(chance >= np.cumsum(self._shares), axis=-1)
        y = np.select([kind == 0, kind == 1], [near, x], y)
        second = np.where(kind[:, None] == 2, round_, np.stack([x, y, z], axis=-1))
        moments = second.sum(axis=-1, keepdims=True) - second
        axes = quaternion.to_matrix(quaternion.normalize(draws.normal(Stream.TRUTH, (4,))))
        return np.asarray((axes * moments[:, None, :]) @ np.swapaxes(axes, -1, -2))

    def _points(self, draws: Draws) -> tuple[Array, Array]:
        low, high = self.count
        half = _log_between(tuple(self.half_side_m), draws.uniform(Stream.TRUTH, (3,)))
        points = 2.0 * draws.uniform(Stream.TRUTH, (high, 3)) - 1.0
        chance = draws.uniform(Stream.TRUTH, (high, 2))
        face = np.eye(3)[np.floor(3.0 * chance[..., 0]).astype(int)]
        normals = face * np.where(chance[..., 1:] < 0.5, -1.0, 1.0)
        points = np.where(face > 0.0, normals, points) * half[:, None]
        used = low + np.floor((high + 1 - low) * draws.uniform(Stream.TRUTH, (1,)))
        return points, np.where((np.arange(high) < used)[..., None], normals, 0.0)


def _between(limits: tuple[float, float], share: Array) -> Array:
    return limits[0] + (limits[1] - limits[0]) * share


def _log_between(limits: tuple[float, ...], share: Array) -> Array:
    return np.asarray(limits[0] * (limits[1] / limits[0]) ** share)
