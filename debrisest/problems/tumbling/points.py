"""Attitude, rate and inertia of a torque-free body from its tracked points themselves.

Nothing is lost on the way: no attitude is made of the points of an epoch, so that two points tell
what they know and quaternions have no signs; the translation of every epoch is removed exactly.
What is estimated is tied to the feature frame, in which no relabeling of axes is left open.
"""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.clock import Clock
from debrisest.filters.replay_model import ReplayModel
from debrisest.problems.tumbling.feature_frame import InFeatureFrame, state_of
from debrisest.problems.tumbling.points_contrasts import compared, contrasts
from debrisest.problems.tumbling.points_replay import replay_model
from debrisest.roles import Keys, Positive


class MotionVariances(Keys):
    """A variance for each block of errors, the same in all directions."""

    attitude_rad2: Positive
    """Variance of the attitude about each axis."""
    rate_rad2_s2: Positive
    """Variance of each rate."""
    log_inertia: Positive
    """Variance of the logarithm of the inertia tensor, each element."""


class TumblingPoints(InFeatureFrame):
    """The whole motion follows from its start; the noise is that of the sensor."""

    needs = ("measured_point", "point_noise", "known_point_f")
    model_kind = "replay_model"
    start_needs = ("q_if", "rate_f", "log_inertia")
    kind: Literal["tumbling_points"]

    def measurements(self, data: Data) -> Array:
        """Return the contrasts of the points (run, time, 3 (feature - 1)), in inertial axes."""
        seen = _seen(data)
        if not compared(seen).any((1, 2)).all():
            raise ValueError("no epoch shows two points of the body, so that nothing is told of it")
        given = np.where(compared(seen)[..., None], contrasts(data["measured_point"], seen), np.nan)
        return given.reshape(*given.shape[:2], -1)

    def model(self, data: Data, clock: Clock) -> ReplayModel:
        """Return motion and measurements with their derivatives."""
        noise = float(data["point_noise"].flat[0])
        if not noise > 0.0:
            raise ValueError("points without noise weigh infinitely: noise_m must be positive")
        return replay_model(data["known_point_f"], _seen(data), noise, clock.times)

    def pack(self, guess: Data, variance: Data) -> tuple[Array, Array]:
        """Return the initial state (run, 12) and the covariance (run, 11, 11) of its errors."""
        state = state_of(guess["q_if"], guess["rate_f"], guess["log_inertia"])
        diagonal = np.concatenate([variance[name] for name in self.start_needs], axis=-1)
        return state, diagonal[..., None] * np.eye(11)


def _seen(data: Data) -> BoolArray:
    return np.asarray(~np.isnan(data["measured_point"]).any(axis=-1))
