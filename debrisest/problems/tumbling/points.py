"""Attitude, rate and inertia of a torque-free body from its tracked points themselves.

Nothing is lost on the way: no attitude is made of the points of an epoch, so that two points tell
what they know and quaternions have no signs; the translation of every epoch is removed exactly.
What is estimated is tied to the feature frame, in which no relabeling of axes is left open.
"""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.assessment.nees import covariance_epochs
from debrisest.attitude import quaternion
from debrisest.attitude.points import features_frame
from debrisest.clock import Clock
from debrisest.filters.estimates import Estimates
from debrisest.filters.replay_model import ReplayModel
from debrisest.problems.tumbling.points_axes import in_principal_axes, rate_by_errors, sigmas
from debrisest.problems.tumbling.points_contrasts import compared, contrasts
from debrisest.problems.tumbling.points_inertia import log_inertia
from debrisest.problems.tumbling.points_replay import replay_model
from debrisest.problems.tumbling.score import scores
from debrisest.roles import Keys, Positive, ProblemPart, Window


class MotionVariances(Keys):
    """A variance for each block of errors, the same in all directions."""

    attitude_rad2: Positive
    rate_rad2_s2: Positive
    log_inertia: Positive


class TumblingPoints(ProblemPart):
    """The whole motion follows from its start; the noise is that of the sensor."""

    needs = ("measured_point", "point_noise", "known_point_f")
    model_kind = "replay_model"
    start_needs = ("q_if", "rate_f", "log_inertia")
    true_state = ("true_q_ib", "true_rate_b", "true_inertia_b", "true_point_b")
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
        state = _state(guess["q_if"], guess["rate_f"], guess["log_inertia"])
        diagonal = np.concatenate([variance[name] for name in self.start_needs], axis=-1)
        return state, diagonal[..., None] * np.eye(11)

    def unpack(self, filtered: Estimates) -> Data:
        """Return the estimates in principal axes by name, each with its sigma."""
        estimates = in_principal_axes(filtered.state)
        return estimates | sigmas(estimates, filtered.sigma)

    def assess(self, data: Data, scored: Window) -> Data:
        """Return errors of attitude, rate and inertia in true principal axes, if known."""
        kept = covariance_epochs(data)
        names = ("q_bf", "rate_b", "moments_b")
        derivative = rate_by_errors({name: data[name][:, kept] for name in names})
        covariance = derivative @ data["covariance"] @ np.swapaxes(derivative, -1, -2)
        return scores(data, scored, covariance)

    def truth(self, data: Data) -> Array | None:
        """Return the true states (run, time, 12)."""
        frame = features_frame(data["true_point_b"])[:, None]
        inertia = np.swapaxes(frame, -1, -2) @ data["true_inertia_b"][:, None] @ frame
        q_if = quaternion.multiply(data["true_q_ib"], quaternion.from_matrix(frame))
        rate_f = (data["true_rate_b"][..., None, :] @ frame)[..., 0, :]
        return _state(q_if, rate_f, log_inertia(inertia))


def _seen(data: Data) -> BoolArray:
    return np.asarray(~np.isnan(data["measured_point"]).any(axis=-1))


def _state(q: Array, rate: Array, log_inertia: Array) -> Array:
    """States (run, ..., 12)."""
    constant = np.broadcast_to(log_inertia, (*q.shape[:-1], 5))
    return np.concatenate([q, rate, constant], axis=-1)
