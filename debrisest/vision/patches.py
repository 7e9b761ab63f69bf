"""Points of a body that are found in every image by what they look like in their best one.

Optical flow from frame to frame drifts. Here the surroundings of a point are taken from the image
that shows them best, brought to every other by the body's motion and the surface's slope, and
aligned there (Lucas and Kanade; the inverse compositional form of Baker and Matthews 2004).
"""

from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.vision.bundle import Bundle, Sightings
from debrisest.vision.optical_flow import Image
from debrisest.vision.stereo_pair import StereoPair

_HALF = 6
"""Half a side of the square that is aligned, px."""
_ITERATIONS = 8
_NEIGHBOURS = 9
"""Points that tell the slope of the surface."""
_LEAST_FACING = 0.5
"""Cosine between the surface's normal and the line of sight."""
_LEAST_ALIKE = 0.85
"""Correlation."""
_FARTHEST = 2.5
"""Most that a point may be from where the motion has it, px."""
_AT_ONCE = 2000


class Slopes(NamedTuple):
    """How the surface lies at each point."""

    normals: Array
    """Outward (point, 3), body axes."""
    tangents: Array
    """Two unit vectors along the surface (point, 2, 3)."""


def slopes(bundle: Bundle, sightings: Sightings) -> Slopes:
    """Return the planes through each point's neighbours; outward is where it is seen from."""
    points = bundle.points
    near = scipy.spatial.cKDTree(points).query(points, min(_NEIGHBOURS, len(points)))[1]
    around = points[near] - points[near].mean(axis=1, keepdims=True)
    axes = np.linalg.svd(around, full_matrices=False)[2]
    eye = -np.einsum("tij,ti->tj", bundle.rotation, bundle.translation)
    towards = np.zeros_like(points)
    np.add.at(towards, sightings.point, _unit(eye[sightings.epoch] - points[sightings.point]))
    sign = np.where(np.sum(axes[:, 2] * towards, axis=-1) < 0.0, -1.0, 1.0)
    return Slopes(sign[:, None] * axes[:, 2], axes[:, :2])


def facing(bundle: Bundle, surface: Slopes, epoch: IntArray, point: IntArray) -> Array:
    """Return the cosine (n,) between the normals of points and the way to the camera."""
    turn, body = bundle.rotation[epoch], bundle.points[point]
    seen = np.einsum("nij,nj->ni", turn, body) + bundle.translation[epoch]
    normal = np.einsum("nij,nj->ni", turn, surface.normals[point])
    return np.asarray(-np.sum(normal * _unit(seen), axis=-1))


def found_again(
    images: list[list[Image]], pair: StereoPair, bundle: Bundle, sightings: Sightings
) -> Sightings:
    """Return where all points are in all images (time, camera) of the pair that show them.

    Every point's pattern is that of the sighting in which it is seen most from the front.
    """
    surface = slopes(bundle, sightings)
    best = _best_sighting(bundle, surface, sightings)
    epochs, count = len(images), len(bundle.points)
    epoch, point = (one.ravel() for one in np.indices((epochs, count)))
    front = facing(bundle, surface, epoch, point) > _LEAST_FACING
    wanted = Sightings(epoch[front], point[front], np.zeros((0, 2, 2)))
    parts = [
        _aligned(images, pair, bundle, surface, sightings, best, Sightings(*part, wanted.pixels))
        for part in zip(_pieces(wanted.epoch), _pieces(wanted.point))
    ]
    return Sightings(*(np.concatenate(each) for each in zip(*parts)))


def _pieces(values: IntArray) -> list[IntArray]:
    return [values[start : start + _AT_ONCE] for start in range(0, len(values), _AT_ONCE)]


def _best_sighting(bundle: Bundle, surface: Slopes, sightings: Sightings) -> IntArray:
    """Return the index of the sighting of each point that is most from the front."""
    front = facing(bundle, surface, sightings.epoch, sightings.point)
    order = np.argsort(front)
    best = np.zeros(len(bundle.points), dtype=np.int64)
    best[sightings.point[order]] = order
    return best


def _aligned(
    images: list[list[Image]],
    pair: StereoPair,
    bundle: Bundle,
    surface: Slopes,
    sightings: Sightings,
    best: IntArray,
    wanted: Sightings,
) -> Sightings:
    """Return those of the wanted sightings that are found, with their pixels."""
    source = best[wanted.point]
    origin = sightings.pixels[source, 0]
    stretch_from = _stretch(pair, bundle, surface, sightings.epoch[source], wanted.point)[:, 0]
    stretch_to = _stretch(pair, bundle, surface, wanted.epoch, wanted.point)
    expected = pair.project(bundle.seen(wanted))
    pixels, good = np.full(expected.shape, np.nan), np.ones(len(origin), dtype=bool)
    for camera in range(2):
        back = stretch_from @ np.linalg.inv(stretch_to[:, camera])
        pattern = _sampled(images, sightings.epoch[source], 0, origin, back)
        pixels[:, camera], found = _align(
            images, wanted.epoch, camera, expected[:, camera], pattern
        )
        good &= found
    return Sightings(wanted.epoch[good], wanted.point[good], pixels[good])


def _stretch(
    pair: StereoPair, bundle: Bundle, surface: Slopes, epoch: IntArray, point: IntArray
) -> Array:
    """Return pixels per metre along the two tangents (n, camera, 2, 2)."""
    turn = bundle.rotation[epoch]
    seen = np.einsum("nij,nj->ni", turn, bundle.points[point]) + bundle.translation[epoch]
    along = np.einsum("nij,nkj->nik", turn, surface.tangents[point])
    return np.asarray(pair.derivative(seen) @ along[:, None])


def _grid() -> Array:
    """Return the pixels of a square from its middle (pixel, 2)."""
    return np.asarray(np.indices((2 * _HALF + 1,) * 2)[::-1].reshape(2, -1).T - _HALF, dtype=float)


def _sampled(
    images: list[list[Image]], epoch: IntArray, camera: int, centre: Array, turn: Array
) -> Array:
    """Return grey values (n, pixel) of squares about centres (n, 2), turned by (n, 2, 2)."""
    places = centre[:, None] + np.einsum("nij,pj->npi", turn, _grid())
    values = np.zeros(places.shape[:2])
    for each in np.unique(epoch):
        of = epoch == each
        values[of] = scipy.ndimage.map_coordinates(
            images[each][camera], np.moveaxis(places[of], -1, 0)[::-1], np.float64, order=1
        )
    return values


def _align(
    images: list[list[Image]], epoch: IntArray, camera: int, expected: Array, pattern: Array
) -> tuple[Array, BoolArray]:
    """Return where patterns (n, pixel) are (n, 2), near what is expected, and which are found."""
    side = 2 * _HALF + 1
    even = _normal(pattern)
    slope = np.gradient(even.reshape(-1, side, side), axis=(1, 2))
    gradient = np.stack([one.reshape(even.shape) for one in slope[::-1]], axis=-1)
    hold = np.swapaxes(gradient, -1, -2) @ gradient + 1e-9 * np.eye(2)
    place, plain = expected.copy(), np.broadcast_to(np.eye(2), (len(expected), 2, 2))
    for _ in range(_ITERATIONS):
        off = even - _normal(_sampled(images, epoch, camera, place, plain))
        step = np.linalg.solve(hold, np.swapaxes(gradient, -1, -2) @ off[..., None])[..., 0]
        place = place + np.clip(step, -1.0, 1.0)
    alike = np.mean(even * _normal(_sampled(images, epoch, camera, place, plain)), axis=-1)
    near = np.linalg.norm(place - expected, axis=-1) < _FARTHEST
    height, width = images[0][camera].shape
    inside = (place > _HALF).all(axis=-1) & (place < [width - _HALF, height - _HALF]).all(axis=-1)
    return place, near & inside & (alike > _LEAST_ALIKE)


def _normal(values: Array) -> Array:
    """Return squares (n, pixel) without their mean and slope, which are light, of variance 1."""
    light = np.linalg.qr(np.insert(_grid(), 0, 1.0, axis=-1))[0]
    centred = values - (values @ light) @ light.T
    return np.asarray(centred / (centred.std(axis=-1, keepdims=True) + 1e-6))


def _unit(vectors: Array) -> Array:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
