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
    """The feature."""
    by_m: Positive
    """How far it is off, in a direction of each run's own."""


class SlowWindow(Keys):
    """A span of time with fewer samples than the scenario has epochs."""

    span_s: Limits[NonNegative]
    """From when until before when."""
    every_s: Positive
    """Time between samples there, rounded to whole steps."""


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
    ]
    """Standard deviation of each coordinate; between two limits it is drawn for each run, evenly in
    its logarithm, and told."""
    depth_noise_factor: Positive = 1.0
    """Noise along the line of sight over that across; the estimators are told the root mean square
    of the three axes."""
    attitude_noise_deg: NonNegative = 0.0
    """White noise of the chaser's attitude about each of its axes, by which all points of an epoch
    turn about the chaser; the estimators are not told."""
    visibility: Literal["back_face", "all"] = "back_face"
    """Which features are seen: those whose surface faces the chaser, or all."""
    missing_share: Annotated[float, Field(ge=0, lt=1)] = 0.0
    """Share of the points that drop out, each by itself."""
    outages_s: list[Limits[NonNegative]] = []
    """From when until before when nothing is seen."""
    slow_s: list[SlowWindow] = []
    """Windows with a slower sampling, whose other epochs show nothing."""
    wrong_match_share: Annotated[float, Field(ge=0, lt=1)] = 0.0
    """Share of the points that are wrong: half of them are off by 1 to 5 m, half exchanged with the
    next feature."""
    biased_feature: BiasedFeature | None = None
    """A feature that is elsewhere than the estimators know it."""
    feature_error_m: NonNegative = 0.0
    """Standard deviation per axis of the known places of all features, drawn for each run; the
    estimators are not told."""
    seen_for_s: Limits[Positive] | None = None
    """Limits of the time after which nothing is seen any more, drawn evenly for each run."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the points (run, time, feature, 3), NaN where one is hidden, and their noise."""
        points, q_ib = data["true_point_b"][:, None], data["true_q_ib"]
        rotated = quaternion.rotate(q_ib[..., None, :], points + self._bias(data, draws))
        noise = draws.normal(Stream.MEASUREMENT_NOISE, rotated.shape[1:])
        sigma = self._sigma(draws)
        exact = self._turned(data["true_position"][..., None, :] + rotated, draws)
        measured = exact + sigma[:, None, None, None] * self._deepened(noise, data["true_position"])
        if self.visibility == "back_face":
            seen = back_face_visible(
                points, data["true_normal_b"][:, None], q_ib, -data["true_position"]
            )
            measured[~seen] = np.nan
        measured[self._unseen(clock.times, draws)] = np.nan
        measured[:, self._skipped(clock)] = np.nan
        if self.missing_share:
            missed = draws.uniform(Stream.CLUTTER, measured.shape[1:-1]) < self.missing_share
            measured[missed] = np.nan
        if self.wrong_match_share:
            measured = with_wrong_matches(measured, self.wrong_match_share, draws)
        told = np.sqrt((2.0 + self.depth_noise_factor**2) / 3.0)
        return {"measured_point": measured, "point_noise": told * sigma}

    def _deepened(self, noise: Array, position: Array) -> Array:
        """Noise (run, time, feature, 3), along the line of sight so many times as large."""
        if self.depth_noise_factor == 1.0:
            return noise
        sight = (position / np.linalg.norm(position, axis=-1, keepdims=True))[..., None, :]
        along = np.sum(noise * sight, axis=-1, keepdims=True) * sight
        return np.asarray(noise + (self.depth_noise_factor - 1.0) * along)

    def _turned(self, points: Array, draws: Draws) -> Array:
        """Points (run, time, feature, 3) in axes that the chaser takes for inertial ones."""
        if self.attitude_noise_deg == 0.0:
            return points
        noise = draws.normal(Stream.CLUTTER, (points.shape[1], 3))
        error = quaternion.exp(np.radians(self.attitude_noise_deg) * noise)
        return quaternion.rotate(error[..., None, :], points)

    def _sigma(self, draws: Draws) -> Array:
        if not isinstance(self.noise_m, list):
            return np.full(len(draws.runs), self.noise_m)
        low, high = self.noise_m
        return np.asarray(low * (high / low) ** draws.uniform(Stream.CLUTTER, (1,))[:, 0])

    def _unseen(self, times: Array, draws: Draws) -> BoolArray:
        """Epochs (run, time) without any point."""
        spans = [_within(times, span) for span in self.outages_s]
        result = np.tile(np.any([np.zeros(len(times), bool), *spans], axis=0), (len(draws.runs), 1))
        if self.seen_for_s is not None:
            low, high = self.seen_for_s
            result |= times >= low + (high - low) * draws.uniform(Stream.CLUTTER, (1,))
        return result

    def _skipped(self, clock: Clock) -> BoolArray:
        """Epochs (time,) between the samples of slow windows."""
        skipped = np.zeros(len(clock.times), bool)
        for window in self.slow_s:
            inside = _within(clock.times, window.span_s)
            every = max(1, round(window.every_s / clock.step))
            skipped |= inside & ((np.cumsum(inside) - 1) % every != 0)
        return skipped

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
        if self.feature_error_m:
            result += self.feature_error_m * draws.normal(Stream.CLUTTER, result.shape[1:])
        return result


def _within(times: Array, span: list[float]) -> BoolArray:
    return np.asarray((times >= span[0]) & (times < span[1]))
