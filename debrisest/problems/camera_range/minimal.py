"""The minimal problem of one camera and a range: every point once, rotation relative to Hill axes.

Attitude, rate, position, velocity, five log-ratios of the inertia and the points: 17 + 3N errors,
and constants of the sensors where they are asked for.
"""

from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.dynamics import log_inertia
from debrisest.dynamics.clohessy_wiltshire import mean_motion_of
from debrisest.filters.estimates import Estimates
from debrisest.filters.landmark_model import LandmarkModel
from debrisest.problems.camera_range.data import require_measurable
from debrisest.problems.camera_range.doubts import doubtful_model
from debrisest.problems.camera_range.model import (
    CORE,
    CORE_ERRORS,
    LOG_INERTIA,
    LOG_INERTIA_ERROR,
    POSITION,
    POSITION_ERROR,
    RATE,
    RATE_ERROR,
    VELOCITY,
    VELOCITY_ERROR,
    CameraAttitude,
    CameraRangeGeometry,
    Q,
    RangeModel,
)
from debrisest.problems.camera_range.score import TRUE_STATE, scores
from debrisest.roles import NonNegative, Positive, ProblemPart, Window
from debrisest.target.start_frame import in_start_frame

_SCORED = np.r_[RATE_ERROR, POSITION_ERROR, VELOCITY_ERROR, LOG_INERTIA_ERROR]
_COUNTED = ("restarts", "dropped", "fit")
"""What filters count over whole runs, for the tables."""
_PLACES = {
    "rate_b": (RATE, RATE_ERROR),
    "relative_position_h": (POSITION, POSITION_ERROR),
    "relative_velocity_h": (VELOCITY, VELOCITY_ERROR),
    "log_inertia": (LOG_INERTIA, LOG_INERTIA_ERROR),
}


class CameraRangeMinimal(ProblemPart):
    """17 + 3N errors; the camera's attitude is known, or implied by the position as in the paper.

    Body axes are those of the camera at time zero, as it is known. Pixels are those of identified
    points; the range is that to the centre of mass, to a surface which is nearer by a constant, or
    to one of the points.
    """

    model_kind = "landmark_model"
    needs: ClassVar[tuple[str, ...]] = (
        *("measured_pixel", "known_q_hc", "focal_px", "pixel_noise", "range_noise"),
        *("attitude_noise", "orbit_position", "orbit_velocity"),
    )
    start_needs = ("rate_b", "relative_position_h", "relative_velocity_h", "point_b")
    true_state = TRUE_STATE
    version = 3
    kind: Literal["camera_range_minimal"]
    camera_attitude: CameraAttitude = "known"
    """Attitude of the camera as it is told, or `implied`: the camera looks at the centre of mass
    exactly, so that its attitude follows from the position."""
    range_to: RangeModel = "centre"
    """What the range is taken to be: that to the centre of mass, to a surface nearer by a constant
    that is estimated, or to one of the points (`landmark_range`)."""
    pixel_noise_px: Positive | None = None
    """Standard deviation of each coordinate of a pixel; none: that of the sensor, with rounding."""
    range_noise_m: Positive | None = None
    """Standard deviation of the range; none: that of the sensor. A surface is not flat: take some
    0.15 m with `bias`."""
    range_bias_m: float = 0.8
    """First guess of the constant by which the surface is nearer."""
    range_bias_sigma_m: Positive = 0.3
    """Standard deviation of that guess."""
    camera_bias_sigma_deg: NonNegative = 0.0
    """Standard deviation of a constant error of the known attitude about each axis, three of which
    are estimated; 0: there is none; not with `implied`."""
    gauge_sigma_deg: NonNegative = 0.0
    """Standard deviation of the attitude at time zero, though it is exact by definition; for
    `landmark_filter`, see there; `landmark_batch` and `landmark_bound` take the attitude as
    exact."""
    log_inertia_sigma: Positive = 0.5
    """Standard deviation of each log-ratio of the inertia."""
    gravity_gradient: bool = True
    """Whether the model has the gravity-gradient torque."""
    point_sigma_m: Positive = 1.5
    """Standard deviation of a point about the place where it is first put, at the depth of the
    centre of mass."""

    @model_validator(mode="after")
    def _one_attitude(self) -> "CameraRangeMinimal":
        if self.camera_attitude == "implied" and self.camera_bias_sigma_deg > 0.0:
            raise ValueError(
                "camera_bias_sigma_deg is that of a known attitude; with camera_attitude implied "
                "there is none"
            )
        return self

    @property
    def needed(self) -> tuple[str, ...]:
        """Return the datasets that are needed: those of the range that is used."""
        if self.range_to == "landmark":
            return (*self.needs, "landmark", "landmark_range")
        return (*self.needs, "measured_range")

    def measurements(self, data: Data) -> Array:
        """Return pixels point by point, then the range; or a range beside each point's pixels."""
        require_measurable(
            data, "landmark_range" if self.range_to == "landmark" else "measured_range"
        )
        pixels = data["measured_pixel"][:, :, 0]
        epochs = pixels.shape[:2]
        if self.range_to != "landmark":
            flat = pixels.reshape(*epochs, -1)
            return np.concatenate([flat, data["measured_range"][..., None]], axis=-1)
        ranged = self._ranged(data) > 0.0
        ranges = np.where(ranged, data["landmark_range"][..., None], np.nan)
        return np.concatenate([pixels, ranges[..., None]], axis=-1).reshape(*epochs, -1)

    def model(self, data: Data, clock: Clock) -> LandmarkModel:
        """Return motion and measurements of one clock step."""
        start = data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]
        white = float(data["attitude_noise"][0]) if self.camera_attitude == "known" else 0.0
        return doubtful_model(
            CameraRangeGeometry(
                camera=quaternion.to_matrix(data["known_q_hc"]),
                points=data["measured_pixel"].shape[3],
                mean_motion=mean_motion_of(*start),
                step=clock.step,
                focal=float(data["focal_px"][0]),
                pixel_sigma=self.pixel_noise_px or float(data["pixel_noise"][0]),
                range_sigma=self.range_noise_m or float(data["range_noise"][0]),
                attitude_sigma=white,
                attitude=self.camera_attitude,
                range_model=self.range_to,
                camera_bias=self.camera_bias_sigma_deg > 0.0,
                depth_sigma=self.point_sigma_m,
                gravity_gradient=self.gravity_gradient,
            )
        )

    def pack(self, guess: Data, variance: Data) -> tuple[Array, Array]:
        """Return the start (run, n) and its covariance (run, n_e, n_e).

        The attitude is left to the model, which takes it from the camera's, and the points to the
        images; the inertia is that of a sphere.
        """
        runs, points = guess["point_b"].shape[:2]
        extras, extra_sigma = self._extras()
        state = np.zeros((runs, CORE + len(extras) + 3 * points))
        diagonal = np.zeros((runs, CORE_ERRORS + len(extras) + 3 * points))
        state[:, 0] = 1.0
        for name in ("rate_b", "relative_position_h", "relative_velocity_h"):
            where, error = _PLACES[name]
            state[:, where], diagonal[:, error] = guess[name], variance[name]
        state[:, CORE : CORE + len(extras)] = extras
        diagonal[:, :3] = np.radians(self.gauge_sigma_deg) ** 2
        diagonal[:, LOG_INERTIA_ERROR] = self.log_inertia_sigma**2
        diagonal[:, CORE_ERRORS : CORE_ERRORS + len(extras)] = np.square(extra_sigma)
        diagonal[:, CORE_ERRORS + len(extras) :] = self.point_sigma_m**2
        return state, diagonal[..., None] * np.eye(diagonal.shape[-1])

    def unpack(self, filtered: Estimates) -> Data:
        """Return the estimated quantities by name, each with its sigma; landmarks may be absent."""
        state, sigma, extras = filtered.state, filtered.sigma, len(self._extras()[0])
        result: Data = {"q_hb": state[..., Q], "q_hb_sigma": _component_sigma(state, sigma)}
        for name, (where, error) in _PLACES.items():
            result[name], result[f"{name}_sigma"] = state[..., where], sigma[..., error]
        points = state[..., CORE + extras :].reshape(*state.shape[:-1], -1, 3)
        spread = sigma[..., CORE_ERRORS + extras :].reshape(points.shape)
        result["point_b"] = points
        result["point_b_sigma"] = np.where(np.isfinite(points), spread, np.nan)
        if self.range_to == "bias":
            result["range_bias"] = state[..., CORE]
            result["range_bias_sigma"] = sigma[..., CORE_ERRORS]
        if self.camera_bias_sigma_deg > 0.0:
            result["camera_bias"] = state[..., CORE + extras - 3 : CORE + extras]
            result["camera_bias_sigma"] = sigma[..., CORE_ERRORS + extras - 3 :][..., :3]
        return result

    def assess(self, data: Data, scored: Window) -> Data:
        """Return errors against the truth, as they are and gauge-free, and consistency."""
        counted = {name: data[name] for name in _COUNTED if name in data}
        return counted | scores(data, self._camera, _SCORED, self.log_inertia_sigma)

    def truth(self, data: Data) -> Array | None:
        """Return the true states (run, time, n)."""
        truth = in_start_frame(data, data[self._camera][:, 0])
        epochs = truth.rate.shape[:2]
        constant = [log_inertia.log_ratios(truth.inertia), *self._true_extras(data)]
        constant.append(truth.point.reshape(epochs[0], -1))
        return np.concatenate(
            [
                *(truth.q_he, truth.rate, data["chaser_position_h"], data["chaser_velocity_h"]),
                *(np.broadcast_to(c[:, None], (*epochs, c.shape[-1])) for c in constant),
            ],
            axis=-1,
        )

    @property
    def _camera(self) -> str:
        """The attitude of the camera that defines the body axes at time zero."""
        return "known_q_hc" if self.camera_attitude == "known" else "true_q_hc"

    def _ranged(self, data: Data) -> Array:
        """1 for the point (run, time, N) that the range is held on; any where there is none."""
        landmark = np.nan_to_num(data["landmark"]).astype(np.int64)
        return np.eye(data["measured_pixel"].shape[3])[landmark]

    def _extras(self) -> tuple[list[float], list[float]]:
        """First guess and sigma of the constants of the sensors."""
        bias = self.range_to == "bias"
        camera = 3 * (self.camera_bias_sigma_deg > 0.0)
        sigma = [self.range_bias_sigma_m] * bias
        sigma += [float(np.radians(self.camera_bias_sigma_deg))] * camera
        return [self.range_bias_m] * bias + [0.0] * camera, sigma

    def _true_extras(self, data: Data) -> list[Array]:
        """The constants that fit the truth best, (run, .) each."""
        result = []
        if self.range_to == "bias":
            distance = np.linalg.norm(data["chaser_position_h"], axis=-1)
            result.append(np.nanmean(distance - data["measured_range"], 1, keepdims=True))
        if self.camera_bias_sigma_deg > 0.0:
            back = quaternion.conjugate(data["known_q_hc"])
            result.append(quaternion.log(quaternion.multiply(back, data["true_q_hc"])).mean(1))
        return result


def _component_sigma(state: Array, sigma: Array) -> Array:
    """1-sigma of the quaternion's components, as if its angles were uncorrelated."""
    w, x, y, z = np.moveaxis(state[..., Q], -1, 0)
    by_turn = np.stack([np.stack(r, -1) for r in ((x, y, z), (w, z, y), (z, w, x), (y, x, w))], -2)
    return np.asarray(0.5 * np.sqrt((by_turn**2 @ sigma[..., :3, None] ** 2)[..., 0]))
