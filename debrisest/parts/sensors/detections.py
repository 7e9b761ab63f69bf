"""What cameras show of a piece of debris: unlabelled points among clutter."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, field_validator

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream, drawn_about
from debrisest.dynamics import kepler, perturbed_orbit
from debrisest.roles import Keys, NonNegative, Positive, SimulationPart
from debrisest.sensors import pinhole
from debrisest.sensors.detections import around, in_image, unlabelled

Count = Annotated[int, Field(ge=1)]


class Clutter(Keys):
    """Points that are new in every frame, spread evenly over a square about the debris' pixel."""

    count: Count
    """Points in each camera and frame."""
    half_width_px: Positive
    """Half the edge of the square."""


MOST_COMPANIONS = 7
"""With the debris as many tracks as can be associated jointly."""
_EXACT = 1e-3
"""Part of what J2 does in one step that may be numerical error."""


class Companions(Keys):
    """Pieces that fly beside the debris for good, and what is known of them at time zero."""

    count: Count
    """Pieces; with the debris eight tracks at most."""
    spread_km: Positive
    """Standard deviation per axis of their distance from the debris."""
    relative_speed_m_s: NonNegative = 10.0
    """Standard deviation per axis of their velocity from the debris'."""
    j2: bool = False
    """The Earth's oblateness acts on them; as in the debris' orbit."""
    position_sigma_m: Positive = 1e4
    """Standard deviation of the first guess of their positions."""
    velocity_sigma_m_s: Positive = 100.0
    """Standard deviation of the first guess of their velocities."""

    @field_validator("count")
    @classmethod
    def _few(cls, count: int) -> int:
        if count > MOST_COMPANIONS:
            raise ValueError(
                f"at most {MOST_COMPANIONS} pieces beside the debris are possible, not {count}"
            )
        return count


class Detections(SimulationPart):
    """The debris' own point with noise, missed at times, and clutter; in random order."""

    needs = (
        *("orbit_position", "orbit_velocity", "observer_position", "true_q_ic"),
        *("true_pixel", "focal_px", "image_half_size"),
    )
    truths = ("target_detection",)
    version = 2
    knows = ("pixel_noise", "start_companion_position", "start_companion_velocity")
    measures = ("measured_pixel",)
    tried = True
    kind: Literal["detections"]
    pixel_noise_px: NonNegative = 1.0
    """Standard deviation of each coordinate, before rounding."""
    whole_pixels: bool = True
    """Round to whole pixels."""
    missing_share: Annotated[float, Field(ge=0, lt=1)] = 0.0
    """Probability that the debris, and each companion, is not found in a frame."""
    clutter: Clutter | None = None
    """Points that are new in each frame, spread evenly over a square about the debris' pixel."""
    companions: Companions | None = None
    """Pieces that fly beside the debris for good."""

    @property
    def given(self) -> tuple[str, ...]:
        """Return the datasets that this sensor gives: guesses only of companions that there are."""
        if self.companions:
            return super().given
        return (*self.truths, "pixel_noise", *self.measures)

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the points (run, time, observer, detection, 2) and which is the debris' own."""
        shown, result = data["true_pixel"][..., None, :], Data()
        if self.companions is not None:
            _require_same_gravity(self.companions, data, clock.times[:2])
            position, velocity = self._companions(self.companions, data, draws)
            result = self._guess(self.companions, position, velocity, draws)
            others = _shown(data, _flown(self.companions.j2, position, velocity, clock.times))
            shown = np.concatenate([shown, others], axis=-2)
        noise = draws.normal(Stream.MEASUREMENT_NOISE, shown.shape[1:])
        found = draws.uniform(Stream.MEASUREMENT_NOISE, shown.shape[1:-1])
        missed = found >= 1 - self.missing_share
        points = np.where(missed[..., None], np.nan, shown + self.pixel_noise_px * noise)
        points = self._with_clutter(points, data["true_pixel"], draws)
        points = np.round(points) if self.whole_pixels else points
        inside = in_image(points, data["image_half_size"][:, None, None, None])
        points = np.where(inside[..., None], points, np.nan)
        rank = draws.uniform(Stream.CLUTTER, points.shape[1:-1])
        detected, own = unlabelled(points, rank)
        sigma = np.sqrt(self.pixel_noise_px**2 + self.whole_pixels / 12)
        return result | {
            "measured_pixel": detected,
            "target_detection": own.astype(np.float64),
            "pixel_noise": np.full(len(own), sigma),
        }

    def _with_clutter(self, points: Array, pixel: Array, draws: Draws) -> Array:
        if self.clutter is None:
            return points
        unit = draws.uniform(Stream.CLUTTER, (*pixel.shape[1:-1], self.clutter.count, 2))
        return np.concatenate([points, around(pixel, unit, self.clutter.half_width_px)], axis=-2)

    def _companions(self, pieces: Companions, data: Data, draws: Draws) -> tuple[Array, Array]:
        """Position and velocity (run, companion, 3) at time zero."""
        spread, speed = 1e3 * pieces.spread_km, pieces.relative_speed_m_s
        drawn = draws.normal(Stream.TRUTH, (2, pieces.count, 3))
        return (
            data["orbit_position"][:, 0, None] + spread * drawn[:, 0],
            data["orbit_velocity"][:, 0, None] + speed * drawn[:, 1],
        )

    def _guess(self, pieces: Companions, position: Array, velocity: Array, draws: Draws) -> Data:
        return drawn_about(
            "start_companion_position", position, pieces.position_sigma_m, draws
        ) | drawn_about("start_companion_velocity", velocity, pieces.velocity_sigma_m_s, draws)


def _flown(j2: bool, position: Array, velocity: Array, times: Array) -> Array:
    """Positions (..., time, 3) of what flies freely."""
    if j2:
        return perturbed_orbit.propagate(position, velocity, times, perturbed_orbit.J2_EARTH)[0]
    return kepler.propagate(position, velocity, times)[0]


def _require_same_gravity(pieces: Companions, data: Data, times: Array) -> None:
    """Raise ValueError where the debris moves exactly as the other value of `j2` has it."""
    start = data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]
    own, other = (_flown(j2, *start, times)[1] for j2 in (pieces.j2, not pieces.j2))
    gap = np.linalg.norm(other - own)
    if np.linalg.norm(data["orbit_position"][0, 1] - other) < _EXACT * gap:
        raise ValueError(
            "the Earth's oblateness acts on the debris and its companions alike; set "
            f"companions.j2 to {str(not pieces.j2).lower()}, as it is in the orbit"
        )


def _shown(data: Data, position: Array) -> Array:
    """Pixels (run, time, observer, piece, 2) of (run, piece, time, 3), NaN out of view."""
    away = np.swapaxes(position, 1, 2)[:, :, None] - data["observer_position"][..., None, :]
    point = quaternion.rotate(quaternion.conjugate(data["true_q_ic"][..., None, :]), away)
    pixel = pinhole.project(point, data["focal_px"][:, None, None, None])
    seen = pinhole.in_view(point, pixel, data["image_half_size"][:, None, None, None])
    return np.where(seen[..., None], pixel, np.nan)
