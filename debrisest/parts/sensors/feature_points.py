"""A sensor of points: the coordinates of the features that are seen."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag

from debrisest.arrays import Array, BoolArray, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.parts.sensors.wrong_matches import with_wrong_matches
from debrisest.roles import Keys, Limits, NonNegative, Positive, SimulationPart
from debrisest.target.visibility import back_face_visible


class BiasedFeature(Keys):
    """A feature that is not where the estimators know it."""

    name: str
    by_m: Positive


def _value_or_limits(given: object) -> str:
    return "limits" if isinstance(given, list) else "value"


class FeaturePoints(SimulationPart):
    """Coordinates of the visible features relative to the chaser, in inertial axes."""

    version = 2
    needs = ("true_point_b", "true_normal_b", "true_q_ib", "true_position")
    knows = ("point_noise",)
    measures = ("measured_point",)
    kind: Literal["feature_points"]
    noise_m: Annotated[
        Annotated[NonNegative, Tag("value")] | Annotated[Limits[Positive], Tag("limits")],
        Discriminator(_value_or_limits),
    ] = Field(description="one value, or limits of a draw")
    visibility: Literal["back_face", "all"] = "back_face"
    wrong_match_share: Annotated[float, Field(ge=0, lt=1)] = 0.0
    biased_feature: BiasedFeature | None = None
    seen_for_s: Limits[Positive] | None = Field(default=None, description="lower and upper limit")

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the points (run, time, feature, 3), NaN where one is hidden, and their noise."""
        points, q_ib = data["true_point_b"][:, None], data["true_q_ib"]
        rotated = quaternion.rotate(q_ib[..., None, :], points + self._bias(data, draws))
        noise = draws.normal(Stream.MEASUREMENT_NOISE, rotated.shape[1:])
        sigma = self._sigma(draws)
        measured = (
            data["true_position"][..., None, :] + rotated + sigma[:, None, None, None] * noise
        )
        if self.visibility == "back_face":
            seen = back_face_visible(
                points, data["true_normal_b"][:, None], q_ib, -data["true_position"]
            )
            measured[~seen] = np.nan
        measured[self._unseen(clock.times, draws)] = np.nan
        if self.wrong_match_share:
            measured = with_wrong_matches(measured, self.wrong_match_share, draws)
        return {"measured_point": measured, "point_noise": sigma}

    def _sigma(self, draws: Draws) -> Array:
        if not isinstance(self.noise_m, list):
            return np.full(len(draws.runs), self.noise_m)
        low, high = self.noise_m
        return np.asarray(low * (high / low) ** draws.uniform(Stream.CLUTTER, (1,))[:, 0])

    def _unseen(self, times: Array, draws: Draws) -> BoolArray:
        """Epochs (run, time) without any point."""
        if self.seen_for_s is None:
            return np.zeros((len(draws.runs), len(times)), dtype=bool)
        low, high = self.seen_for_s
        return np.asarray(times >= low + (high - low) * draws.uniform(Stream.CLUTTER, (1,)))

    def _bias(self, data: Data, draws: Draws) -> Array:
        """Offset of the features (run, 1, feature, 3), in a direction of each run's own."""
        result = np.zeros((len(draws.runs), 1, *data["true_point_b"].shape[1:]))
        if self.biased_feature is not None:
            names = [str(name) for name in data["feature"]]
            if self.biased_feature.name not in names:
                raise ValueError(
                    f"biased_feature.name: no feature is called {self.biased_feature.name}; "
                    f"there are {', '.join(names)}"
                )
            way = draws.normal(Stream.CLUTTER, (3,))
            way *= self.biased_feature.by_m / np.linalg.norm(way, axis=-1, keepdims=True)
            result[:, 0, names.index(self.biased_feature.name)] = way
        return result
