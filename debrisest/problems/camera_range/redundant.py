"""The published filter's problem: every point in the body's and in the camera's axes."""

from typing import ClassVar, Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.dynamics.clohessy_wiltshire import mean_motion_of
from debrisest.filters.estimates import Estimates
from debrisest.filters.model import Model
from debrisest.problems.camera_range.data import require_measurable
from debrisest.problems.camera_range.redundant_model import (
    CORE,
    ELEMENTS,
    INERTIA,
    MATRIX,
    POSITION,
    RATE,
    VELOCITY,
    CameraGeometry,
    Q,
    redundant_model,
)
from debrisest.problems.camera_range.score import scores
from debrisest.problems.process_noise import ProcessNoise
from debrisest.roles import Positive, ProblemPart, Window

_ROWS = np.array([*range(4, 13)])
"""Rate, position and velocity in the covariance."""
_NAMES = (
    *("q_cb", "rate_b", "relative_position_h", "relative_velocity_h", "inertia_b"),
    *("point_b", "point_c"),
)


class CameraRangeRedundant(ProblemPart):
    """6N + 19 components, additive errors; the camera's attitude follows from the position."""

    model_kind = "model"
    needs: ClassVar[tuple[str, ...]] = (
        *("measured_pixel", "measured_range", "orbit_position", "orbit_velocity"),
        *("focal_px", "pixel_noise", "range_noise"),
    )
    start_needs = _NAMES
    kind: Literal["camera_range_redundant"]
    pixel_noise_px: Positive | None = None
    """Standard deviation of each coordinate of a pixel; none: that of the sensor, with rounding."""
    range_noise_m: Positive | None = None
    """Standard deviation of the range; none: that of the sensor."""
    process_noise: ProcessNoise = ProcessNoise()
    """Standard deviations added per step."""

    def measurements(self, data: Data) -> Array:
        """Return pixels point by point, and the range (run, time, 2N + 1)."""
        require_measurable(data)
        pixels = data["measured_pixel"]
        flat = pixels.reshape(*pixels.shape[:2], -1)
        return np.concatenate([flat, data["measured_range"][..., None]], axis=-1)

    def model(self, data: Data, clock: Clock) -> Model:
        """Return process and measurement of one clock step."""
        start = data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]
        points = data["measured_pixel"].shape[3]
        known = CameraGeometry(
            points, mean_motion_of(*start), clock.step, float(data["focal_px"][0])
        )
        variance = np.zeros(CORE + 6 * points)
        variance[RATE] = self.process_noise.rate_rad_s**2
        variance[VELOCITY] = self.process_noise.velocity_m_s**2
        return redundant_model(
            known,
            self.pixel_noise_px or float(data["pixel_noise"][0]),
            self.range_noise_m or float(data["range_noise"][0]),
            variance,
        )

    def pack(self, guess: Data, variance: Data) -> tuple[Array, Array]:
        """Return the initial state (run, n) and its diagonal covariance (run, n, n)."""
        diagonal = _state(variance)
        return _state(guess), diagonal[..., None] * np.eye(diagonal.shape[-1])

    def unpack(self, filtered: Estimates) -> Data:
        """Return the estimated quantities by name, each with its sigma."""
        sigma = {f"{name}_sigma": part for name, part in _parts(filtered.sigma).items()}
        return _parts(filtered.state) | sigma

    def assess(self, data: Data, scored: Window) -> Data:
        """Return errors against the truth, as they are and gauge-free, and consistency."""
        return scores(data, "true_q_hc", _ROWS)


def _state(parts: Data) -> Array:
    """States (run, n) of a guess, whose inertia is a tensor."""
    rows, columns = zip(*ELEMENTS)
    flat = {name: parts[name].reshape(len(parts[name]), -1) for name in _NAMES}
    flat["inertia_b"] = parts["inertia_b"][:, rows, columns]
    return np.concatenate([flat[name] for name in _NAMES], axis=-1)


def _parts(state: Array) -> Data:
    points = (state.shape[-1] - CORE) // 6
    shape = (*state.shape[:-1], points, 3)
    return {
        "q_cb": state[..., Q],
        "rate_b": state[..., RATE],
        "relative_position_h": state[..., POSITION],
        "relative_velocity_h": state[..., VELOCITY],
        "inertia_b": state[..., INERTIA][..., MATRIX],
        "point_b": state[..., CORE : CORE + 3 * points].reshape(shape),
        "point_c": state[..., CORE + 3 * points :].reshape(shape),
    }
