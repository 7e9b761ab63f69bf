"""Attitude of a body frame from points of the body, seen at an unknown translation.

``model (feature, 3)`` holds the features in the body frame ``b``, ``measured (..., feature, 3)`` in
inertial axes from any origin, NaN where a feature is not seen. Both estimates are rotation matrices
``R_ib (..., 3, 3)``, NaN where fewer than three features, or only features in line, are seen.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.attitude.rotation import nearest_rotation

_COLLINEAR = 1e-5  # ratio of a set's width to its length below which it is a line


def features_frame(points: Array) -> Array:
    """Axes ``(..., 3, 3)``, as columns, of the frame built on the first three points.

    Biondi et al. 2017, Eq 9: from the first point to the second, the normal of the three points,
    and the vector product of these two. NaN if the points are in line.
    """
    first = points[..., 1, :] - points[..., 0, :]
    normal = np.cross(first, points[..., 2, :] - points[..., 0, :])
    axes = np.stack([first, normal, np.cross(first, normal)], axis=-1)
    with np.errstate(invalid="ignore"):
        return np.asarray(axes / np.linalg.norm(axes, axis=-2, keepdims=True))


def triad(model: Array, measured: Array) -> Array:
    """Attitude from the first three features seen that are not in line, in catalogue order."""
    triple, enough = _first_triples(model, _seen(measured))
    points_i = np.take_along_axis(measured, triple[..., None], axis=-2)
    attitude = features_frame(points_i) @ np.swapaxes(features_frame(model[triple]), -1, -2)
    return np.where(enough[..., None, None], attitude, np.nan)


def wahba(model: Array, measured: Array) -> Array:
    """Least-squares attitude from all features seen (centred Kabsch, a proper rotation)."""
    seen = _seen(measured)[..., None]
    count = np.sum(seen, axis=-2, keepdims=True)
    correlation = np.swapaxes(_centred(measured, seen), -1, -2) @ model
    attitude, scale = nearest_rotation(correlation)
    enough = (count[..., 0, 0] >= 3) & (scale[..., 1] > _COLLINEAR**2 * scale[..., 0])
    return np.where(enough[..., None, None], attitude, np.nan)


def wahba_information(model: Array, measured: Array) -> Array:
    """Inverse of the variance ``(...)`` of `wahba`, summed over the axes, for noise of 1 m.

    In m^2 per rad^2. The covariance of the rotation vector is that of the Kabsch problem,
    ``(tr F - F)^-1`` with ``F`` the sum of ``f f^T`` over the features seen, from their mean. Zero
    where they are in line, or none.
    """
    seen = _seen(measured)[..., None]
    feature = _centred(np.broadcast_to(model, measured.shape), seen)
    spread = np.linalg.eigvalsh(np.swapaxes(feature, -1, -2) @ feature)
    lever = np.maximum(np.sum(spread, axis=-1, keepdims=True) - spread, 0.0)
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / np.sum(1.0 / lever, axis=-1))


def _centred(points: Array, seen: BoolArray) -> Array:
    """Points from the mean of those seen, zero for the others."""
    count = np.sum(seen, axis=-2, keepdims=True)
    mean = np.sum(points, axis=-2, keepdims=True, where=seen) / np.maximum(count, 1)
    return np.where(seen, points - mean, 0.0)


def _seen(measured: Array) -> BoolArray:
    return np.asarray(~np.isnan(measured).any(axis=-1))


def _first_triples(model: Array, seen: BoolArray) -> tuple[IntArray, BoolArray]:
    """Indices ``(..., 3)`` of three features, and whether there are three."""
    first = np.argmax(seen, axis=-1)
    rest = seen & (np.arange(model.shape[0]) != first[..., None])
    second = np.argmax(rest, axis=-1)
    third = rest & ~_in_line(model, first, second)
    triple = np.stack([first, second, np.argmax(third, axis=-1)], axis=-1)
    return triple, np.asarray(third.any(axis=-1))


def _in_line(model: Array, first: IntArray, second: IntArray) -> BoolArray:
    """Whether each feature lies on the line of two of them, ``(..., feature)``."""
    base = (model[second] - model[first])[..., None, :]
    side = model - model[first][..., None, :]
    area = np.linalg.norm(np.cross(base, side), axis=-1)
    length = np.linalg.norm(base, axis=-1) * np.linalg.norm(side, axis=-1)
    return np.asarray(area <= _COLLINEAR * length)
