"""What a chaser with one camera and a range finder measures of its target."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from debrisest.arrays import Array, BoolArray, Data, IntArray
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.dynamics.pointing import camera_axes
from debrisest.roles import Limits, NonNegative, Positive, SimulationPart
from debrisest.sensors import pinhole
from debrisest.target.start_frame import attitude_in_hill
from debrisest.target.surface import (
    FEWEST_POINTS,
    box_faces,
    depth_along,
    hidden_by_box,
    hull_faces,
)
from debrisest.target.visibility import back_face_visible

Share = Annotated[float, Field(ge=0, le=1)]
HalfSize = Annotated[list[Positive], Field(min_length=2, max_length=2)]
HalfSides = Annotated[list[Positive], Field(min_length=3, max_length=3)]


class CameraRange(SimulationPart):
    """A camera that looks at the target's centre, and a range finder beside it.

    Pixels are counted from the middle of the image. Points are identified without error, but for
    false matches, which lie anywhere in the middle of the image.
    """

    needs = (
        *("chaser_position_h", "orbit_position", "orbit_velocity"),
        *("true_q_ib", "true_point_b"),
    )
    truths = ("true_q_hc",)
    knows = ("known_q_hc", "focal_px", "pixel_noise", "range_noise", "attitude_noise")
    measures = ("measured_pixel", "measured_range", "landmark", "landmark_range")
    tried = True
    version = 2
    kind: Literal["camera_range"]
    focal_px: Positive = 1000.0
    """Focal length in pixels."""
    pixel_noise_px: Positive = 1.0
    """Standard deviation of each coordinate."""
    whole_pixels: bool = True
    """Round to whole pixels; estimators reckon with 1/12 px² more."""
    range_noise_m: Positive = 0.01
    """Standard deviation of both ranges."""
    range_to: Literal["centre", "surface"] = "centre"
    """What the range is measured to: the centre of mass, or the surface on the line to it."""
    half_sides_m: HalfSides | None = None
    """The body as a box, for `surface` and `box`; without it the surface is the hull of the
    points."""
    half_size_px: HalfSize | None = None
    """Half the width and half the height of the image, in which a pixel must lie; none: no
    limits."""
    dark_s: list[Limits[NonNegative]] = []
    """Eclipses: from when until before when the camera shows nothing; the range finder goes on."""
    visibility: Literal["all", "back_face", "box"] = "all"
    """Which points are seen: all, those whose normal faces the chaser, or those that the box does
    not hide."""
    missing_share: Share = 0.0
    """Probability that a visible point is not found in an image."""
    false_match_share: Share = 0.0
    """Probability that a pixel is a false match."""
    false_match_px: Positive = 200.0
    """False matches lie anywhere in a square of this half side."""
    attitude_noise_deg: NonNegative = 0.0
    """White noise of the camera's known attitude, about each of its axes; the estimators are told
    it."""
    attitude_bias_deg: NonNegative = 0.0
    """Standard deviation of a constant error of the camera's known attitude, drawn for each run."""

    @model_validator(mode="after")
    def _has_a_body(self) -> "CameraRange":
        if self.visibility == "box" and self.half_sides_m is None:
            raise ValueError("visibility box needs half_sides_m, the half sides of the body")
        return self

    @property
    def needed(self) -> tuple[str, ...]:
        """Return the datasets that this sensor needs: normals only where backs are hidden."""
        return (*self.needs, "true_normal_b") if self.visibility == "back_face" else self.needs

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return pixels (run, time, 1, feature, 2), ranges (run, time), the camera's attitude."""
        q_hc, points_c = self._points_in_front(data)
        noise = draws.normal(Stream.MEASUREMENT_NOISE, (*points_c.shape[1:-1], 2))
        pixels = pinhole.project(points_c, self.focal_px) + self.pixel_noise_px * noise
        pixels = self._with_false_matches(pixels, draws)
        seen = self._seen(data, pixels.shape[1:-1], draws)
        seen &= self._lit(clock.times)[:, None] & self._inside(pixels)
        pixels[~seen] = np.nan
        runs = len(draws.runs)
        return {
            "measured_pixel": (np.round(pixels) if self.whole_pixels else pixels)[:, :, None],
            **self._ranges(data, points_c, seen, draws),
            **self._attitude(q_hc, draws),
            "focal_px": np.full(runs, self.focal_px),
            "pixel_noise": np.full(runs, self._image_noise()),
            "range_noise": np.full(runs, self.range_noise_m),
            "attitude_noise": np.full(runs, np.radians(self.attitude_noise_deg)),
        }

    def _points_in_front(self, data: Data) -> tuple[Array, Array]:
        """The camera's attitude and the points in its axes; ValueError if it cannot see them."""
        count = data["true_point_b"].shape[1]
        if count < FEWEST_POINTS:
            raise ValueError(
                f"pose and shape from one camera need at least {FEWEST_POINTS} points, "
                f"the target has {count}"
            )
        q_hc = quaternion.from_matrix(camera_axes(data["chaser_position_h"]))
        points_c = points_in_camera(data, q_hc)
        _require_in_front(points_c, data["time_s"])
        return q_hc, points_c

    def _lit(self, times: Array) -> BoolArray:
        """Epochs (time,) at which the target is not in the Earth's shadow."""
        dark = [(times >= begin) & (times < end) for begin, end in self.dark_s]
        return np.asarray(~np.any([np.zeros(len(times), bool), *dark], axis=0))

    def _inside(self, pixels: Array) -> BoolArray:
        """Points (run, time, feature) whose pixels lie inside the image."""
        half_size = np.inf if self.half_size_px is None else np.array(self.half_size_px)
        return np.asarray(np.all(np.abs(pixels) <= half_size, axis=-1))

    def _image_noise(self) -> float:
        """Rounding to whole pixels adds the variance of a uniform error, 1/12."""
        return float(np.sqrt(self.pixel_noise_px**2 + self.whole_pixels / 12))

    def _with_false_matches(self, pixels: Array, draws: Draws) -> Array:
        drawn = draws.uniform(Stream.CLUTTER, (*pixels.shape[1:-1], 3))
        anywhere = self.false_match_px * (2 * drawn[..., 1:] - 1)
        return np.where(drawn[..., :1] < self.false_match_share, anywhere, pixels)

    def _seen(self, data: Data, shape: tuple[int, ...], draws: Draws) -> BoolArray:
        found = draws.uniform(Stream.CLUTTER, shape) >= self.missing_share
        if self.visibility == "all":
            return found
        points, q_hb = data["true_point_b"][:, None], attitude_in_hill(data)
        observer_h = data["chaser_position_h"]
        if self.visibility == "box":
            observer_b = quaternion.rotate(quaternion.conjugate(q_hb), observer_h)
            return found & ~hidden_by_box(points, observer_b, np.array(self.half_sides_m))
        normals = data["true_normal_b"][:, None]
        return np.asarray(found & back_face_visible(points, normals, q_hb, observer_h))

    def _ranges(self, data: Data, points_c: Array, seen: BoolArray, draws: Draws) -> Data:
        distance = np.linalg.norm(data["chaser_position_h"], axis=-1)
        landmark = front_landmark(points_c, distance, seen)
        held: BoolArray = np.asarray(seen.any(-1))
        to_points = np.linalg.norm(points_c, axis=-1)
        to_landmark = np.take_along_axis(to_points, landmark[..., None], axis=-1)[..., 0]
        if self.range_to == "surface":
            distance = distance - self._surface(data, distance)
        if not np.all(distance > 0):
            raise ValueError("the range is zero or below: the chaser is inside the target")
        noise = self.range_noise_m * draws.normal(Stream.MEASUREMENT_NOISE, (distance.shape[1], 2))
        return {
            "measured_range": distance + noise[..., 0],
            "landmark": np.where(held, landmark, np.nan),
            "landmark_range": np.where(held, to_landmark + noise[..., 1], np.nan),
        }

    def _surface(self, data: Data, distance: Array) -> Array:
        """Distance (run, time) from the centre of mass to the surface, on the line of sight."""
        direction_h = data["chaser_position_h"] / distance[..., None]
        direction_b = quaternion.rotate(quaternion.conjugate(attitude_in_hill(data)), direction_h)
        if self.half_sides_m is not None:
            return depth_along(direction_b, box_faces(np.array(self.half_sides_m)))
        hulls = [hull_faces(points) for points in data["true_point_b"]]
        return np.stack([depth_along(d, hull) for d, hull in zip(direction_b, hulls)])

    def _attitude(self, q_hc: Array, draws: Draws) -> Data:
        """The camera's attitude and what is known of it: noise and bias about the camera's axes."""
        noise = draws.normal(Stream.MEASUREMENT_NOISE, (q_hc.shape[1], 3))
        bias = draws.normal(Stream.TRUTH, (1, 3))
        error = self.attitude_noise_deg * noise + self.attitude_bias_deg * bias
        known = quaternion.multiply(q_hc, quaternion.exp(np.radians(error)))
        return {"true_q_hc": q_hc, "known_q_hc": known}


def points_in_camera(data: Data, q_hc: Array) -> Array:
    """Return the points (run, time, feature, 3) from the camera, in its axes."""
    arms = quaternion.rotate(attitude_in_hill(data)[..., None, :], data["true_point_b"][:, None])
    sight = arms - data["chaser_position_h"][..., None, :]
    return quaternion.rotate(quaternion.conjugate(q_hc)[..., None, :], sight)


def front_landmark(points_c: Array, distance: Array, seen: BoolArray) -> IntArray:
    """Return which point (run, time) a range finder is held on: of those seen, and if possible in
    front of the centre of mass, the one nearest the optical axis; any where none is seen.
    """
    off_axis = np.hypot(points_c[..., 0], points_c[..., 1]) / points_c[..., 2]
    behind = points_c[..., 2] > distance[..., None]
    return np.asarray(np.argmin(off_axis + behind * 1e3 + ~seen * 1e6, axis=-1))


def _require_in_front(points_c: Array, times: Array) -> None:
    behind = np.argwhere(~(points_c[..., 2] > 0))
    if len(behind):
        _, epoch, point = behind[0]
        raise ValueError(
            f"point {point + 1} of the target is behind the camera at {times[epoch]:g} s; "
            "the chaser must keep farther away than the target is large"
        )
