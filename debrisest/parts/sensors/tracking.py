"""What satellites with cameras see of a piece of debris, and what is known at the start."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.roles import NonNegative, Positive, SimulationPart

HalfSize = Annotated[list[Positive], Field(min_length=2, max_length=2)]


class PinholeCamera(SimulationPart):
    """The camera that all satellites have."""

    needs = ("observer_position",)
    gives = ("camera_scale", "image_half_size")
    kind: Literal["pinhole_camera"]
    scale_px: Positive = Field(description="focal length in pixels")
    half_size_px: HalfSize = Field(description="half the width and the height of the image")

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return scale (run,) and half size (run, 2)."""
        runs = len(draws.runs)
        return {
            "camera_scale": np.full(runs, self.scale_px),
            "image_half_size": np.tile(self.half_size_px, (runs, 1)),
        }


class AttitudeKnowledge(SimulationPart):
    """The attitude of the cameras as an estimator is told, with an error that does not change."""

    needs = ("true_q_ic",)
    gives = ("known_q_ic", "start_attitude_bias")
    kind: Literal["attitude_knowledge"]
    bias_mrad: NonNegative = Field(0.0, description="1 sigma per axis of each camera, per run")

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return ``known_q_ic`` (run, time, observer, 4); the bias is in camera axes."""
        true, sigma = data["true_q_ic"], 1e-3 * self.bias_mrad
        drawn = draws.normal(Stream.MEASUREMENT_NOISE, (true.shape[2], 3))
        bias = quaternion.exp(sigma * drawn)[:, None]
        return {
            "known_q_ic": quaternion.multiply(true, bias),
            "start_attitude_bias": np.zeros(drawn.shape),
            "start_attitude_bias_sigma": np.full(drawn.shape, sigma),
        }


class OrbitGuess(SimulationPart):
    """An estimate of the debris' orbit at time zero, drawn about the truth."""

    needs = ("orbit_position", "orbit_velocity")
    gives = ("start_orbit_position", "start_orbit_velocity")
    kind: Literal["orbit_guess"]
    position_sigma_m: Positive
    velocity_sigma_m_s: Positive

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the drawn state and its known sigma."""
        position, velocity = data["orbit_position"][:, 0], data["orbit_velocity"][:, 0]
        return drawn_about("start_orbit_position", position, self.position_sigma_m, draws) | (
            drawn_about("start_orbit_velocity", velocity, self.velocity_sigma_m_s, draws)
        )


def drawn_about(name: str, true: Array, sigma: float, draws: Draws) -> Data:
    """Return a first guess of ``true`` (run, ...) and its sigma, by name."""
    noise = draws.normal(Stream.INITIAL_ERROR, true.shape[1:])
    return {name: true + sigma * noise, f"{name}_sigma": np.full(true.shape, sigma)}
