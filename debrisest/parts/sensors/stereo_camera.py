"""What a leader with two cameras measures of a target, and what it knows at the start."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from debrisest.arrays import Array, BoolArray, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.dynamics import inertia_ratios, kepler
from debrisest.dynamics.relative_orbit import leader_orbit
from debrisest.roles import NonNegative, Positive, SimulationPart
from debrisest.sensors import stereo
from debrisest.target.visibility import back_face_visible

_POSE = ("true_position", "true_velocity", "true_q_lt", "true_rate_l")


class StereoCamera(SimulationPart):
    """Two parallel cameras that look along track: slopes, their flow, and the disparity.

    A noise that is not given means "not measured". A feature can be missing, as a whole, by chance
    or because the surface there faces away, and any single value can be an outlier.
    """

    needs = (*_POSE, "true_point_b")
    gives = ("baseline", "measured_pixel", "measured_flow", "measured_disparity")
    kind: Literal["stereo_camera"]
    baseline_m: Positive
    pixel_noise: Positive | None = Field(None, description="of slopes, focal length 1")
    flow_noise_1_s: Positive | None = None
    disparity_noise: Positive | None = None
    from_s: NonNegative = Field(1.0, description="time of the first measurement")
    missing_per_frame: Annotated[int, Field(ge=0)] = 0
    occlusion: bool = Field(False, description="features whose surface faces away are not seen")
    outlier_share: Annotated[float, Field(ge=0, le=1)] = 0.0
    outlier_sigmas: NonNegative = 100.0

    @model_validator(mode="after")
    def _measures_something(self) -> "StereoCamera":
        if not any((self.pixel_noise, self.flow_noise_1_s, self.disparity_noise)):
            raise ValueError(
                "cameras that measure nothing; give at least one of: pixel_noise, flow_noise_1_s, "
                "disparity_noise"
            )
        return self

    @property
    def needed(self) -> tuple[str, ...]:
        """Return the datasets that are needed, with occlusion the normals too."""
        return (*self.needs, "true_normal_b") if self.occlusion else self.needs

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return pixels and flow (run, time, camera, feature, 2), disparity, known noise."""
        exact, seen = _shown(data, self.baseline_m)
        noises = (self.pixel_noise, self.flow_noise_1_s, self.disparity_noise)
        sigma = np.repeat([noise or 0.0 for noise in noises], (4, 4, 1))
        errors = draws.normal(Stream.MEASUREMENT_NOISE, exact.shape[1:])
        rank = draws.uniform(Stream.CLUTTER, exact.shape[1:3]).argsort(-1).argsort(-1)
        measured = exact + sigma * (errors + self._outliers(exact.shape[1:], draws))
        seen = seen & (rank >= self.missing_per_frame)
        if self.occlusion:
            seen = seen & _facing(data, self.baseline_m)
        measured[~(seen & (clock.times >= self.from_s)[:, None])] = np.nan
        return self._named(measured, noises) | {"baseline": _each(self.baseline_m, measured)}

    def _outliers(self, shape: tuple[int, ...], draws: Draws) -> Array:
        hit = draws.uniform(Stream.CLUTTER, shape) < self.outlier_share
        sign = np.sign(draws.normal(Stream.CLUTTER, shape))
        return np.asarray(self.outlier_sigmas * hit * sign)

    def _named(self, measured: Array, noises: tuple[float | None, ...]) -> Data:
        groups = {
            "pixel": _by_camera(measured[..., stereo.PIXELS]),
            "flow": _by_camera(measured[..., stereo.FLOW]),
            "disparity": measured[..., stereo.DISPARITY][..., 0],
        }
        result: Data = {}
        for (name, values), noise in zip(groups.items(), noises):
            if noise is not None:
                result[f"measured_{name}"] = values
                result[f"{name}_noise"] = _each(noise, measured)
        return result


class AngularAcceleration(SimulationPart):
    """The target's angular acceleration in principal axes, as if it could be measured."""

    needs = ("true_q_lt", "true_rate_l", "true_inertia_ratio", "orbit_position", "orbit_velocity")
    gives = ("measured_angular_acceleration",)
    kind: Literal["angular_acceleration"]
    noise_rad_s2: Positive
    from_s: NonNegative = Field(1.0, description="time of the first measurement")

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the angular acceleration (run, time, 3) and its known noise."""
        start = data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]
        leader = leader_orbit(clock.times, *kepler.shape_and_anomaly(*start))
        rate_i = data["true_rate_l"] + leader.rate[:, None] * np.array([0.0, 0.0, 1.0])
        rate_t = quaternion.rotate(quaternion.conjugate(data["true_q_lt"]), rate_i)
        exact = inertia_ratios.angular_acceleration(rate_t, data["true_inertia_ratio"][:, None])
        errors = draws.normal(Stream.MEASUREMENT_NOISE, exact.shape[1:])
        measured = exact + self.noise_rad_s2 * errors
        measured[:, clock.times < self.from_s] = np.nan
        return {
            "measured_angular_acceleration": measured,
            "angular_acceleration_noise": _each(self.noise_rad_s2, measured),
        }


class FirstGuess(SimulationPart):
    """An estimate at time zero, drawn about the truth, the same for all estimators."""

    needs = (*_POSE, "true_inertia_ratio", "true_point_b")
    gives = tuple(
        f"start_{name}"
        for name in ("position", "velocity", "rate_l", "q_lt", "inertia_ratio", "point_b")
    )
    kind: Literal["first_guess"]
    position_sigma_m: Positive
    velocity_sigma_m_s: Positive
    rate_sigma_deg_s: Positive
    q_sigma: Positive = Field(description="of every component; twice that is the angle's")
    inertia_ratio_sigma: Positive
    point_sigma_m: Positive

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the drawn state and its known sigma; the quaternion has unit norm again."""
        sigmas = {
            "position": self.position_sigma_m,
            "velocity": self.velocity_sigma_m_s,
            "rate_l": float(np.radians(self.rate_sigma_deg_s)),
            "q_lt": self.q_sigma,
            "inertia_ratio": self.inertia_ratio_sigma,
            "point_b": self.point_sigma_m,
        }
        result: Data = {}
        for name, sigma in sigmas.items():
            constant = name in ("inertia_ratio", "point_b")
            true = data[f"true_{name}"] if constant else data[f"true_{name}"][:, 0]
            drawn = true + sigma * draws.normal(Stream.INITIAL_ERROR, true.shape[1:])
            result[f"start_{name}"] = quaternion.normalize(drawn) if name == "q_lt" else drawn
            result[f"start_{name}_sigma"] = np.full(true.shape, sigma)
        return result


def _shown(data: Data, baseline: float) -> tuple[Array, BoolArray]:
    """Exact rows (run, time, feature, 9), and which points lie in front of the cameras."""
    arm = quaternion.rotate(data["true_q_lt"][..., None, :], data["true_point_b"][:, None])
    point = data["true_position"][..., None, :] + arm
    turning = np.cross(data["true_rate_l"][..., None, :], arm)
    velocity = data["true_velocity"][..., None, :] + turning
    in_front = point[..., 1] > 0
    point[..., 1] = np.where(in_front, point[..., 1], 1.0)
    return stereo.measure(point, velocity, baseline), in_front


def _facing(data: Data, baseline: float) -> BoolArray:
    """Which features' surfaces face both cameras, (run, time, feature).

    A feature that one camera alone sees cannot be matched. The target's axes stand for body axes,
    the leader's for inertial ones.
    """
    points, normals = data["true_point_b"][:, None], data["true_normal_b"][:, None]
    first, second = (
        back_face_visible(points, normals, data["true_q_lt"], camera - data["true_position"])
        for camera in baseline * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    )
    return np.asarray(first & second)


def _by_camera(rows: Array) -> Array:
    """From (run, time, feature, 4) to (run, time, camera, feature, 2)."""
    return np.moveaxis(rows.reshape(*rows.shape[:-1], 2, 2), -2, -3)


def _each(value: float, measured: Array) -> Array:
    return np.full(len(measured), value)
