"""What is known at first of a target that a leader has approached."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream, drawn_about
from debrisest.dynamics.inertia_ratios import slopes
from debrisest.roles import PerAxis, Positive, SimulationPart

_TRIES = 1000
"""Draws of the inertia ratios, of which the first that is a body's counts."""
_NAMES = ("position", "velocity", "rate_l", "q_lt", "inertia_ratio", "point_b")


class DrawnPose(SimulationPart):
    """An estimate at time zero, drawn about the truth, the same for all estimators."""

    needs = tuple(f"true_{name}" for name in _NAMES)
    knows = tuple(f"start_{name}" for name in _NAMES)
    kind: Literal["drawn_pose"]
    position_sigma_m: PerAxis[Positive]
    """Standard deviation of the position, leader's axes."""
    velocity_sigma_m_s: PerAxis[Positive]
    """Standard deviation of the velocity, leader's axes."""
    rate_sigma_deg_s: PerAxis[Positive]
    """Standard deviation of the rate, leader's axes."""
    q_sigma: Positive
    """Standard deviation of each component of `q_lt`, which is then normalised; an angle's is twice
    that."""
    inertia_ratio_sigma: Positive | None
    """Standard deviation of each inertia ratio; null: another start gives the ratios."""
    point_sigma_m: PerAxis[Positive]
    """Standard deviation of the features, target's axes."""
    bodies_only: bool = False
    """Draw inertia ratios again until no moment exceeds the sum of the others."""

    @property
    def given(self) -> tuple[str, ...]:
        """Return the datasets that are drawn."""
        left_out = () if self.inertia_ratio_sigma else ("start_inertia_ratio",)
        return tuple(name for name in self.knows if name not in left_out)

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the drawn state and its known sigma; the quaternion has unit norm again."""
        sigmas = {
            "position": self.position_sigma_m,
            "velocity": self.velocity_sigma_m_s,
            "rate_l": np.radians(self.rate_sigma_deg_s),
            "q_lt": self.q_sigma,
            "inertia_ratio": self.inertia_ratio_sigma,
            "point_b": self.point_sigma_m,
        }
        result: Data = {}
        for name, sigma in sigmas.items():
            if sigma is None:
                continue
            constant = name in ("inertia_ratio", "point_b")
            true = data[f"true_{name}"] if constant else data[f"true_{name}"][:, 0]
            result |= drawn_about(f"start_{name}", true, np.asarray(sigma), draws)
        result["start_q_lt"] = quaternion.normalize(result["start_q_lt"])
        if self.bodies_only and self.inertia_ratio_sigma:
            true, sigma = data["true_inertia_ratio"], self.inertia_ratio_sigma
            result["start_inertia_ratio"] = _body(true, sigma, draws)
        return result


def _body(true: Array, sigma: float, draws: Draws) -> Array:
    """Return the first ratios (run, 2) drawn about the true ones that a body can have."""
    noise = draws.normal(Stream.INITIAL_ERROR, (_TRIES, 2))
    drawn = true[:, None] + sigma * noise
    first = (np.abs(slopes(drawn)) < 1.0).all(-1).argmax(axis=1)
    return np.asarray(drawn[np.arange(len(true)), first])
