"""The orbit of a piece of debris from the pixels of several satellites' cameras."""

from typing import Literal

import numpy as np
from pydantic import model_validator

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.filters.association.single import labelled
from debrisest.filters.estimates import Estimates
from debrisest.filters.scan_model import ScanModel
from debrisest.problems.orbit_from_pixels.model import ORBIT, ObserverGeometry, scan_model
from debrisest.problems.orbit_from_pixels.score import scores, true_bias
from debrisest.roles import NonNegative, PerAxis, PerCoordinate, Positive, ProblemPart, Window


class OrbitFromPixels(ProblemPart):
    """The problem of this file, its noises and what of the data it uses."""

    needs = ("observer_position", "known_q_ic", "focal_px", "section", "measured_pixel")
    model_kind = "scan_model"
    start_needs = ("orbit_position", "orbit_velocity")
    true_state = ("orbit_position", "orbit_velocity")
    kind: Literal["orbit_from_pixels"]
    acceleration_noise_m_s2: PerAxis[NonNegative]
    """Standard deviation of an acceleration that lasts a step, inertial axes."""
    pixel_variance_px2: PerCoordinate[Positive] | None = None
    """Variance of both coordinates of a point, or of each; left out, it is that of `detections`:
    the noise squared, and 1/12 of rounding."""
    updates_in_control: bool = False
    """Use what cameras show while they turn."""
    attitude_bias: bool = False
    """Estimate the constant errors of the known attitudes, three for each camera."""
    tracks: Literal["debris", "all"] = "debris"
    """What is tracked: `all` are the companions as well, for `joint_association`; not with
    `attitude_bias`."""
    detections: Literal["all", "own"] = "all"
    """Points that are used; `own` are the debris' own, for `known_association` and
    `linearised_at_truth`."""

    @model_validator(mode="after")
    def _one_at_a_time(self) -> "OrbitFromPixels":
        if self.tracks == "all" and self.attitude_bias:
            raise ValueError("attitude_bias: true is not possible with tracks: all")
        return self

    @property
    def gives_model(self) -> str:
        """Return the kind of model: that of one track, or of several."""
        return "tracks_model" if self.tracks == "all" else self.model_kind

    @property
    def needed(self) -> tuple[str, ...]:
        """Return the datasets that are needed, of labelled detections the true labels too."""
        own = ["target_detection"] if self.detections == "own" else []
        noise = ["pixel_noise"] if self.pixel_variance_px2 is None else []
        return (*self.needs, *own, *noise)

    @property
    def start_needed(self) -> tuple[str, ...]:
        """Return the first guesses that are needed, that of the attitude's error if estimated."""
        return (*self.start_needs, "attitude_bias") if self.attitude_bias else self.start_needs

    @property
    def truth_needed(self) -> tuple[str, ...]:
        """Return the datasets that the truth is made of."""
        return (*self.true_state, "true_q_ic") if self.attitude_bias else self.true_state

    def measurements(self, data: Data) -> Array:
        """Return the points (run, time, observer, detection, 2)."""
        points = data["measured_pixel"]
        if self.detections == "own":
            points = labelled(points, data["target_detection"].astype(np.int64))
        if self.updates_in_control:
            return points
        turning = data["section"] % 2 == 1
        return np.where(turning[..., None, None, None], np.nan, points)

    def model(self, data: Data, clock: Clock) -> ScanModel:
        """Return process and measurement of one clock step."""
        to_camera = quaternion.to_matrix(quaternion.conjugate(data["known_q_ic"]))
        return scan_model(
            ObserverGeometry(
                step=clock.step,
                observer=_time_first(data["observer_position"]),
                to_camera=_time_first(to_camera),
                scale=data["focal_px"],
                acceleration_noise=np.asarray(self.acceleration_noise_m_s2),
                pixel_variance=self._variance(data),
                with_bias=self.attitude_bias,
            )
        )

    def _variance(self, data: Data) -> Array:
        if self.pixel_variance_px2 is not None:
            return np.asarray(self.pixel_variance_px2)
        noise = float(data["pixel_noise"][0])
        if not noise > 0.0:
            raise ValueError("points without noise weigh infinitely; give pixel_variance_px2")
        return np.asarray(noise**2)

    def pack(self, guess: Data, variance: Data) -> tuple[Array, Array]:
        """Return state (run, n) and covariance (run, n, n); with tracks (run, track, ...)."""
        state = np.concatenate([guess["orbit_position"], guess["orbit_velocity"]], axis=-1)
        covariance = _covariance(variance, "orbit")
        if self.tracks == "all":
            return _with_companions(state, covariance, guess, variance)
        if not self.attitude_bias:
            return state, covariance
        biases = guess["attitude_bias"], variance["attitude_bias"]
        return _with_bias(state, covariance, *(each.reshape(len(state), -1) for each in biases))

    def unpack(self, filtered: Estimates) -> Data:
        """Return the estimated quantities by name, each with its sigma."""
        result: Data = {}
        for values, end in ((filtered.state, ""), (filtered.sigma, "_sigma")):
            result[f"debris_position{end}"] = values[..., :3]
            result[f"debris_velocity{end}"] = values[..., 3:6]
            if self.attitude_bias:
                bias = values[..., 6:].reshape(*values.shape[:2], -1, 3)
                result[f"attitude_bias{end}"] = bias
        return result

    def assess(self, data: Data, scored: Window) -> Data:
        """Return errors of the orbit and consistency, as far as ``data`` holds a truth."""
        return scores(data)

    def truth(self, data: Data) -> Array | None:
        """Return the true states (run, time, n)."""
        parts = [data["orbit_position"], data["orbit_velocity"]]
        if self.attitude_bias:
            bias = true_bias(data)
            parts.append(bias.reshape(*bias.shape[:2], -1))
        return np.concatenate(parts, axis=-1)


def _time_first(values: Array) -> Array:
    return np.ascontiguousarray(np.moveaxis(values, 1, 0))


def _covariance(variance: Data, name: str) -> Array:
    """Covariance (run, ..., 6, 6) of the first guess of a position and a velocity."""
    diagonal = np.concatenate([variance[f"{name}_position"], variance[f"{name}_velocity"]], axis=-1)
    return np.asarray(diagonal[..., None] * np.eye(6))


def _with_bias(
    state: Array, covariance: Array, bias: Array, variance: Array
) -> tuple[Array, Array]:
    n = state.shape[-1] + bias.shape[-1]
    whole = np.zeros((len(state), n, n))
    whole[:, ORBIT, ORBIT] = covariance
    whole[:, ORBIT.stop :, ORBIT.stop :] = variance[..., None] * np.eye(bias.shape[-1])
    return np.concatenate([state, bias], axis=-1), whole


def _with_companions(
    state: Array, covariance: Array, guess: Data, variance: Data
) -> tuple[Array, Array]:
    """The debris is track 0, companions follow, if there are any."""
    tracks, spread = state[:, None], covariance[:, None]
    if "companion_position" not in guess:
        return tracks, spread
    pieces = [guess["companion_position"], guess["companion_velocity"]]
    others = np.concatenate(pieces, axis=-1)
    return (
        np.concatenate([tracks, others], axis=1),
        np.concatenate([spread, _covariance(variance, "companion")], axis=1),
    )
