"""What is guessed of a target of unknown shape before it has been filmed."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.roles import PerAxis, Positive, SimulationPart
from debrisest.target.start_frame import in_start_frame


class DrawnShape(SimulationPart):
    """Position, rate and inertia drawn about the truth, no velocity, all points at one depth.

    The first image gives the points' directions; their depth is that of the centre of mass. Body
    axes are the camera's at time zero.
    """

    needs = (
        *("measured_pixel", "measured_range", "focal_px"),
        *("chaser_position_h", "true_q_hc", "true_q_ib", "true_rate_b", "true_inertia_b"),
    )
    knows = tuple(
        f"start_{name}"
        for name in (
            *("relative_position_h", "relative_velocity_h", "q_cb", "rate_b", "inertia_b"),
            *("point_b", "point_c"),
        )
    )
    kind: Literal["drawn_shape"]
    position_sigma_m: PerAxis[Positive] = 2.0
    """Standard deviation of each component of the chaser's position, which then gets the length of
    the first range."""
    velocity_sigma_m_s: PerAxis[Positive] = 0.03
    """Standard deviation of each component of the chaser's velocity, which is guessed to be
    zero."""
    q_sigma: Positive = 1e-3
    """Standard deviation of each component of the attitude, which is exact by definition."""
    rate_sigma_deg_s: PerAxis[Positive] = 0.3
    """Standard deviation of each component of the rate."""
    inertia_sigma_kg_m2: Positive = 1.0
    """Standard deviation of each element of the inertia tensor."""
    point_sigma_m: Positive = 0.3
    """Standard deviation of the points, across the line of sight."""
    depth_sigma_m: Positive = 1.5
    """Standard deviation of the points' depth, and all round for points that the first image
    lacks."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the first guess and its sigma."""
        truth, runs = in_start_frame(data, data["true_q_hc"][:, 0]), len(draws.runs)
        drawn = draws.normal(Stream.INITIAL_ERROR, (4, 3))
        position_sigma = np.asarray(self.position_sigma_m)
        position = data["chaser_position_h"][:, 0] + position_sigma * drawn[:, 0]
        position *= (data["measured_range"][:, 0] / np.linalg.norm(position, axis=-1))[:, None]
        rate_sigma = np.radians(self.rate_sigma_deg_s)
        error = _symmetric(drawn[:, 2:].reshape(runs, 6))
        point_c, sigma = self._points(data, position)
        guess: Data = {
            "relative_position_h": position,
            "relative_velocity_h": np.zeros((runs, 3)),
            "q_cb": np.tile([1.0, 0.0, 0.0, 0.0], (runs, 1)),
            "rate_b": truth.rate[:, 0] + rate_sigma * drawn[:, 1],
            "inertia_b": truth.inertia + self.inertia_sigma_kg_m2 * error,
            "point_c": point_c,
            "point_b": point_c - [0.0, 0.0, 1.0] * np.linalg.norm(position, axis=-1)[:, None, None],
        }
        sigmas: dict[str, float | Array] = {
            "relative_position_h": position_sigma,
            "relative_velocity_h": np.asarray(self.velocity_sigma_m_s),
            "q_cb": self.q_sigma,
            "rate_b": rate_sigma,
            "inertia_b": self.inertia_sigma_kg_m2,
            "point_c": sigma,
            "point_b": sigma,
        }
        return _named(guess, sigmas)

    def _points(self, data: Data, position: Array) -> tuple[Array, Array]:
        """Points (run, feature, 3) on the plane through the centre of mass, and their sigma.

        Of a point that the first image lacks, nothing is known but that it is near.
        """
        pixel = data["measured_pixel"][:, 0, 0]
        depth = np.linalg.norm(position, axis=-1)[:, None]
        seen = ~np.isnan(pixel[..., 0])
        slope = np.where(seen[..., None], pixel, 0.0) / data["focal_px"][:, None, None]
        point = np.concatenate([slope, np.ones_like(slope[..., :1])], axis=-1) * depth[..., None]
        across = np.where(seen, self.point_sigma_m, self.depth_sigma_m)
        sigma = np.stack([across, across, np.full_like(across, self.depth_sigma_m)], axis=-1)
        return point, sigma


def _symmetric(elements: Array) -> Array:
    """Symmetric matrices (..., 3, 3) of their six elements."""
    return np.asarray(elements[..., [[0, 3, 4], [3, 1, 5], [4, 5, 2]]])


def _named(guess: Data, sigmas: dict[str, float | Array]) -> Data:
    spread = {f"start_{n}_sigma": np.broadcast_to(s, guess[n].shape) for n, s in sigmas.items()}
    return {f"start_{name}": value for name, value in guess.items()} | spread
