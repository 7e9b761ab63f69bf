"""Two ways to hand a scenario's stereo cameras to a filter: additive errors, or a replay."""

from typing import ClassVar, Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.filters.estimates import Estimates
from debrisest.filters.model import Model
from debrisest.filters.replay_model import ReplayModel
from debrisest.problems.process_noise import ProcessNoise
from debrisest.problems.stereo_pose.additive import additive_model
from debrisest.problems.stereo_pose.chart import ATTITUDE_ERROR
from debrisest.problems.stereo_pose.data import (
    DATASETS,
    NAMES,
    Measure,
    geometry_of,
    measured_of,
    noise_of,
    parts_of,
    shown_of,
    state_of,
)
from debrisest.problems.stereo_pose.model import RATE, VELOCITY, K, Q, StereoGeometry
from debrisest.problems.stereo_pose.replay import replay_model
from debrisest.problems.stereo_pose.score import scores
from debrisest.roles import NonNegative, Positive, ProblemPart, Window


class _StereoPose(ProblemPart):
    """What both forms share: the measurements, and how estimates are scored."""

    needs: ClassVar[tuple[str, ...]] = (
        *("baseline", "focal_px", "orbit_position", "orbit_velocity"),
    )
    start_needs: ClassVar[tuple[str, ...]] = tuple(NAMES)
    true_state = tuple(f"true_{name}" for name in NAMES)
    measures: list[Measure] | None = None
    """What is used; none: all that is measured."""
    pixel_noise_px: Positive | None = None
    """Standard deviation of each coordinate; none: that of the cameras."""
    flow_noise_px_s: Positive | None = None
    """Standard deviation of the flow; none: that of the cameras."""
    disparity_noise_px: Positive | None = None
    """Standard deviation of the disparity; none: that of the cameras."""
    acceleration_noise_rad_s2: Positive | None = None
    """Standard deviation of the angular acceleration; none: that of its sensor."""
    score_delay_s: NonNegative = 0.0
    """Errors are taken against the truth so much later, rounded to whole steps."""

    @property
    def needed(self) -> tuple[str, ...]:
        """Return the datasets that are needed: those measurements too that are asked for."""
        asked = [DATASETS[name] for name in self.measures or []]
        return (*self.needs, *(f"measured_{name}" for name in asked))

    def measurements(self, data: Data) -> Array:
        """Return the chosen measurements (run, time, m)."""
        return measured_of(data, shown_of(data, self.measures))

    def noise(self, data: Data, known: StereoGeometry) -> Array:
        """Return the noise of the measurements (m,) that the estimator reckons with, 1 sigma."""
        thought = {
            "pixel_noise": self.pixel_noise_px,
            "flow_noise": self.flow_noise_px_s,
            "disparity_noise": self.disparity_noise_px,
            "angular_acceleration_noise": self.acceleration_noise_rad_s2,
        }
        told = {name: np.array([sigma]) for name, sigma in thought.items() if sigma is not None}
        return noise_of(data | told, known)

    def assess(self, data: Data, scored: Window) -> Data:
        """Return errors against the truth, or the truth a delay later, and consistency."""
        late = Clock(data["time_s"] - data["time_s"][0]).nearest(self.score_delay_s)
        return scores(data, late)

    def truth(self, data: Data) -> Array | None:
        """Return the true states (run, time, n)."""
        return state_of(data, "true_")


class StereoPoseAdditive(_StereoPose):
    """All components of the state as errors, the quaternion's among them."""

    model_kind = "model"
    kind: Literal["stereo_pose_additive"]
    process_noise: ProcessNoise = ProcessNoise()
    """Standard deviations added per step."""
    transition: Literal["exact", "first_order"] = "exact"
    """Derivative of a step: exact, or I + F dt."""
    raw_rotation: bool = False
    """Rotate with the quaternion as it is, not divided by its norm."""

    def model(self, data: Data, clock: Clock) -> Model:
        """Return process and measurement of one clock step."""
        known = geometry_of(data, clock, self.measures, self.raw_rotation)
        variance = np.zeros(15 + 3 * known.points)
        variance[VELOCITY] = self.process_noise.velocity_m_s**2
        variance[RATE] = self.process_noise.rate_rad_s**2
        noise = np.diag(self.noise(data, known) ** 2)
        return additive_model(known, np.diag(variance), noise, self.transition == "exact")

    def pack(self, guess: Data, variance: Data) -> tuple[Array, Array]:
        """Return the initial state (run, n) and covariance (run, n, n)."""
        return state_of(guess), _diagonal(state_of(variance))

    def unpack(self, filtered: Estimates) -> Data:
        """Return the estimated quantities by name, each with its sigma."""
        return _with_sigmas(filtered.state, filtered.sigma)


class StereoPose(_StereoPose):
    """The whole motion follows from its start: rotation vectors in place of quaternions."""

    version = 2
    model_kind = "replay_model"
    kind: Literal["stereo_pose"]

    def model(self, data: Data, clock: Clock) -> ReplayModel:
        """Return trajectories, measurements and charts."""
        known = geometry_of(data, clock, self.measures)
        variance = {name: data[f"start_{name}_sigma"][:1] ** 2 for name in NAMES}
        prior = np.sqrt(_plain(state_of(variance))[0])
        return replay_model(known, self.noise(data, known), prior)

    def pack(self, guess: Data, variance: Data) -> tuple[Array, Array]:
        """Return the initial state (run, n) and the covariance (run, n_e, n_e) of its errors."""
        return state_of(guess), _diagonal(_plain(state_of(variance)))

    def unpack(self, filtered: Estimates) -> Data:
        """Return the estimated quantities by name, each with its sigma.

        A quaternion component's follows from the angles' as if these were uncorrelated.
        """
        q, turn = filtered.state[..., Q], filtered.sigma[..., ATTITUDE_ERROR]
        w, x, y, z = np.moveaxis(q, -1, 0)
        by_turn = np.stack([np.stack(r, -1) for r in ((x, y, z), (w, z, y), (z, w, x), (y, x, w))])
        spread = 0.5 * np.sqrt((np.moveaxis(by_turn, 0, -2) ** 2 @ turn[..., None] ** 2)[..., 0])
        parts = [filtered.sigma[..., : Q.start], spread, filtered.sigma[..., Q.start + 3 :]]
        return _with_sigmas(filtered.state, np.concatenate(parts, axis=-1))


def _plain(variance: Array) -> Array:
    """Variances of plain errors: an angle is twice a component of the quaternion."""
    angle = 4 * variance[..., Q.start : Q.start + 3]
    parts = [variance[..., : Q.start], angle, variance[..., K.start :]]
    return np.concatenate(parts, axis=-1)


def _diagonal(variance: Array) -> Array:
    """Covariances (run, n, n) of independent errors."""
    return np.asarray(variance[..., None] * np.eye(variance.shape[-1]))


def _with_sigmas(state: Array, sigma: Array) -> Data:
    sigmas = {f"{name}_sigma": part for name, part in parts_of(sigma).items()}
    return parts_of(state) | sigmas
