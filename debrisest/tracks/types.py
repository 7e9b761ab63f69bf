"""What the readers give: tracks, poses, cameras and body points, with what was understood."""

from dataclasses import dataclass

import numpy as np

from debrisest.arrays import Array, IntArray


@dataclass(frozen=True)
class Tracks:
    """Features over time; NaN = not seen.

    ``points (epoch, feature, 3)``, m, in inertially fixed axes with the chaser as origin (or in the
    chaser's axes, if its attitude is given), with ``point_sigma`` of the same shape. ``pixels
    (epoch, camera, feature, 2)``: u to the right, v down, from the image's corner, as measured
    (distorted). ``ranges`` in m, ``(epoch,)`` to the target as a whole or ``(epoch, feature)``.
    ``lines (epoch,)``: the first line of each epoch in the file.
    """

    source: str
    times: Array
    features: tuple[str, ...]
    lines: IntArray
    points: Array | None = None
    point_sigma: Array | None = None
    cameras: tuple[str, ...] = ()
    pixels: Array | None = None
    ranges: Array | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Poses:
    """Attitudes ``q (epoch, 4)`` over time, scalar first, unit norm, with positions, m, if given.

    ``q`` takes body vectors into the axes in which ``position (epoch, 3)`` of the body's origin is
    given: the camera's or inertially fixed ones. ``sigma_rad (epoch,)`` is that of each axis.
    """

    source: str
    times: Array
    q: Array
    lines: IntArray
    position: Array | None = None
    sigma_rad: Array | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Rates:
    """Rates ``rate (epoch, 3)``, rad/s, in axes fixed in the body, with ``sigma (epoch,)`` of each
    component, if given."""

    source: str
    times: Array
    rate: Array
    lines: IntArray
    sigma: Array | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class BodyPoints:
    """Known geometry: ``points (feature, 3)``, m, in body axes."""

    source: str
    features: tuple[str, ...]
    points: Array
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Camera:
    """Pinhole camera with OpenCV's conventions: z ahead, x right, y down.

    Focal lengths and principal point in pixels; ``distortion`` in OpenCV's order (k1, k2, p1, p2,
    k3, ...), empty for none; ``size`` is width and height, px.
    """

    name: str
    focal_px: tuple[float, float]
    centre_px: tuple[float, float]
    distortion: tuple[float, ...] = ()
    size: tuple[int, int] | None = None


@dataclass(frozen=True)
class Rig:
    """Cameras fixed to each other: ``x_c = rotation[c] x_0 + translation[c]``, m.

    ``rotation (camera, 3, 3)`` and ``translation (camera, 3)`` take points from the axes of the
    first camera to those of camera c, as OpenCV's ``R`` and ``T`` do.
    """

    cameras: tuple[Camera, ...]
    rotation: Array
    translation: Array
    notes: tuple[str, ...] = ()

    @property
    def baselines(self) -> Array:
        """Distance ``(camera,)``, m, of each camera from the first."""
        return np.asarray(np.linalg.norm(self.translation, axis=-1))
