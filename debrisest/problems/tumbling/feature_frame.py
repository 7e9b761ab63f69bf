"""What is estimated in the feature frame, in which no relabeling of axes is left open."""

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.assessment.nees import covariance_epochs
from debrisest.attitude import quaternion
from debrisest.attitude.points import features_frame
from debrisest.filters.estimates import Estimates
from debrisest.problems.tumbling.points_axes import in_principal_axes, rate_by_errors, sigmas
from debrisest.problems.tumbling.points_inertia import log_inertia
from debrisest.problems.tumbling.score import scores
from debrisest.roles import ProblemPart, Window


class InFeatureFrame(ProblemPart):
    """Estimates of attitude, rate and inertia (run, time, 12), seen from principal axes."""

    true_state = ("true_q_ib", "true_rate_b", "true_inertia_b", "true_point_b")

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
        return scores(self.in_true_frame(data), scored, covariance)

    def in_true_frame(self, data: Data) -> Data:
        """Return the data with ``q_bf`` from the true feature frame, by default the estimate's."""
        return data

    def truth(self, data: Data) -> Array:
        """Return the true states (run, time, 12)."""
        frame = features_frame(data["true_point_b"])[:, None]
        inertia = np.swapaxes(frame, -1, -2) @ data["true_inertia_b"][:, None] @ frame
        q_if = quaternion.multiply(data["true_q_ib"], quaternion.from_matrix(frame))
        rate_f = (data["true_rate_b"][..., None, :] @ frame)[..., 0, :]
        return state_of(q_if, rate_f, log_inertia(inertia))


def state_of(q: Array, rate: Array, log_inertia: Array) -> Array:
    """States (run, ..., 12)."""
    constant = np.broadcast_to(log_inertia, (*q.shape[:-1], 5))
    return np.concatenate([q, rate, constant], axis=-1)
