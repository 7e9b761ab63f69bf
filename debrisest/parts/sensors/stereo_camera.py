"""What a leader with two cameras measures of a target."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from debrisest.arrays import Array, BoolArray, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.roles import NonNegative, Positive, SimulationPart, UnitQuaternion
from debrisest.sensors import stereo
from debrisest.target.visibility import back_face_visible

_POSE = ("true_position", "true_velocity", "true_q_lt", "true_rate_l")


class StereoCamera(SimulationPart):
    """Two parallel cameras: pixels, their flow, and the disparity.

    They look along track unless they are turned. With a focal length of one pixel, pixels are
    slopes.
    A noise that is not given means "not measured". A feature can be missing, as a whole, by chance
    or because the surface there faces away, and any single value can be an outlier.
    """

    needs = (*_POSE, "true_point_b")
    knows = ("baseline", "focal_px", "pixel_noise", "flow_noise", "disparity_noise", "camera_q_lc")
    measures = ("measured_pixel", "measured_flow", "measured_disparity")
    kind: Literal["stereo_camera"]
    baseline_m: Positive
    """Distance between the cameras."""
    q_lc: UnitQuaternion = [1.0, 0.0, 0.0, 0.0]
    """Attitude of both cameras, from camera axes (x from the first to the second, y ahead) to the
    leader's; by default these are the same, and the cameras look along track."""
    focal_px: Positive = 1.0
    """Focal length in pixels; with 1 pixels are slopes."""
    pixel_noise_px: Positive | None = None
    """Standard deviation of each coordinate."""
    flow_noise_px_s: Positive | None = None
    """Standard deviation of the flow."""
    disparity_noise_px: Positive | None = None
    """Standard deviation of the disparity."""
    from_s: NonNegative = 1.0
    """Time of the first measurement."""
    missing_per_frame: Annotated[int, Field(ge=0)] = 0
    """Features, drawn at each epoch, that are not seen."""
    visibility: Literal["all", "back_face"] = "all"
    """Which features are seen: all, or those whose surface faces both cameras; that needs a target
    with normals."""
    outlier_share: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Probability that a single value is an outlier."""
    outlier_sigmas: NonNegative = 100.0
    """What an outlier adds or subtracts, in standard deviations."""

    @model_validator(mode="after")
    def _measures_something(self) -> "StereoCamera":
        if not any(self._noises):
            raise ValueError(
                "cameras that measure nothing; give at least one of: pixel_noise_px, "
                "flow_noise_px_s, disparity_noise_px"
            )
        return self

    @property
    def needed(self) -> tuple[str, ...]:
        """Return the datasets that are needed: normals only where backs are hidden."""
        return (*self.needs, "true_normal_b") if self.visibility == "back_face" else self.needs

    @property
    def given(self) -> tuple[str, ...]:
        """Return the datasets that these cameras give: those with a noise."""
        named = zip(self.measures, self.knows[2:5], self._noises)
        turned = self.knows[5:] if self._turned else ()
        measured = (name for *pair, noise in named if noise for name in pair)
        return (*self.knows[:2], *measured, *turned)

    @property
    def _turned(self) -> bool:
        return self.q_lc != [1.0, 0.0, 0.0, 0.0]

    @property
    def _noises(self) -> tuple[float | None, ...]:
        return self.pixel_noise_px, self.flow_noise_px_s, self.disparity_noise_px

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return pixels and flow (run, time, camera, feature, 2), disparity, known noise."""
        camera = np.array(self.q_lc)
        exact, seen = _shown(data, self.baseline_m, camera)
        sigma = np.repeat([noise or 0.0 for noise in self._noises], (4, 4, 1))
        errors = draws.normal(Stream.MEASUREMENT_NOISE, exact.shape[1:])
        rank = draws.uniform(Stream.CLUTTER, exact.shape[1:3]).argsort(-1).argsort(-1)
        measured = self.focal_px * exact + sigma * (errors + self._outliers(exact.shape[1:], draws))
        seen = seen & (rank >= self.missing_per_frame)
        if self.visibility == "back_face":
            seen = seen & _facing(data, self.baseline_m, camera)
        measured[~(seen & (clock.times >= self.from_s)[:, None])] = np.nan
        turned = {"camera_q_lc": np.tile(camera, (len(measured), 1))} if self._turned else {}
        return self._named(measured) | {
            "baseline": _each(self.baseline_m, measured),
            "focal_px": _each(self.focal_px, measured),
            **turned,
        }

    def _outliers(self, shape: tuple[int, ...], draws: Draws) -> Array:
        hit = draws.uniform(Stream.CLUTTER, shape) < self.outlier_share
        sign = np.sign(draws.normal(Stream.CLUTTER, shape))
        return np.asarray(self.outlier_sigmas * hit * sign)

    def _named(self, measured: Array) -> Data:
        groups = {
            "pixel": _by_camera(measured[..., stereo.PIXELS]),
            "flow": _by_camera(measured[..., stereo.FLOW]),
            "disparity": measured[..., stereo.DISPARITY][..., 0],
        }
        result: Data = {}
        for (name, values), noise in zip(groups.items(), self._noises):
            if noise is not None:
                result[f"measured_{name}"] = values
                result[f"{name}_noise"] = _each(noise, measured)
        return result


def _shown(data: Data, baseline: float, q_lc: Array) -> tuple[Array, BoolArray]:
    """Exact rows (run, time, feature, 9), and which points lie in front of the cameras."""
    arm = quaternion.rotate(data["true_q_lt"][..., None, :], data["true_point_b"][:, None])
    point = data["true_position"][..., None, :] + arm
    turning = np.cross(data["true_rate_l"][..., None, :], arm)
    velocity = data["true_velocity"][..., None, :] + turning
    point, velocity = (_in_camera(vectors, q_lc) for vectors in (point, velocity))
    in_front = point[..., 1] > 0
    point[..., 1] = np.where(in_front, point[..., 1], 1.0)
    return stereo.measure(point, velocity, baseline), in_front


def _in_camera(vectors: Array, q_lc: Array) -> Array:
    return vectors @ quaternion.to_matrix(q_lc)


def _facing(data: Data, baseline: float, q_lc: Array) -> BoolArray:
    """Which features' surfaces face both cameras, (run, time, feature).

    A feature that one camera alone sees cannot be matched. The target's axes stand for body axes,
    the leader's for inertial ones.
    """
    points, normals = data["true_point_b"][:, None], data["true_normal_b"][:, None]
    places = quaternion.rotate(q_lc, baseline * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    first, second = (
        back_face_visible(points, normals, data["true_q_lt"], camera - data["true_position"])
        for camera in places
    )
    return np.asarray(first & second)


def _by_camera(rows: Array) -> Array:
    """From (run, time, feature, 4) to (run, time, camera, feature, 2)."""
    return np.moveaxis(rows.reshape(*rows.shape[:-1], 2, 2), -2, -3)


def _each(value: float, measured: Array) -> Array:
    return np.full(len(measured), value)
