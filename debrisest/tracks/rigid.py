"""Whether tracked points are one rigid body, and what would make them one.

Distances between features of a rigid body do not change. Which features break this, and whether a
mended axis or another unit repairs it, is told in sentences; nothing is changed. Two columns that
are swapped in a whole file, or one whose sign is, leave a mirrored body that is as rigid: only a
known geometry can tell.
"""

from collections.abc import Iterator
from itertools import permutations

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.tracks.geometry import compare_geometry
from debrisest.tracks.mirror import reflections
from debrisest.tracks.report import Refusal
from debrisest.tracks.rows import POINT
from debrisest.tracks.types import BodyPoints, Tracks

_MOST = 2_000_000  # distances looked at; more epochs are thinned out
_FAR = 6.0  # times the usual spread: a feature that is not rigid with the rest
_FEW = 5  # epochs: with fewer, one feature's spread by chance is another's many times
_SOFT = 0.1  # of the body's size: a spread that no noise of use has


def check_rigid(tracks: Tracks, body: BodyPoints | None = None) -> list[str]:
    """Sentences on what is not rigid or is mirrored in tracked points, empty if all is well.

    A `Refusal` tells that nothing can be estimated. ``body`` is the known geometry, if there is
    one: names and lengths are compared with it too.
    """
    if tracks.points is None or len(tracks.times) < 2 or len(tracks.features) < 3:
        return []
    step = 1 + tracks.points[..., 0].size * len(tracks.features) // _MOST
    points = tracks.points[::step]
    told = _loose(tracks, points, tracks.lines[::step]) + reflections(tracks)
    return told + (compare_geometry(tracks, points, body) if body is not None else [])


def _deviations(points: Array) -> Array:
    """How far each distance is from its median over time, ``(epoch, feature, feature)``, or NaN."""
    distance = np.linalg.norm(points[:, :, None] - points[:, None], axis=-1)
    distance[:, np.eye(points.shape[1], dtype=bool)] = np.nan
    return np.asarray(np.abs(distance - _median(distance, 0)))


def _median(values: Array, axis: int) -> Array:
    """Median without NaN; NaN where there is nothing else."""
    empty = np.isnan(values).all(axis, keepdims=True)
    median = np.nanmedian(np.where(empty, 0.0, values), axis=axis, keepdims=True)
    return np.where(empty, np.nan, median).squeeze(axis)


def _typical(points: Array) -> tuple[Array, float]:
    """Median deviation of each feature's distances ``(feature,)``, and of all; 0 where unknown."""
    pairs = _median(_deviations(points), 0)
    usual = _median(pairs.ravel(), 0)
    return np.nan_to_num(_median(pairs, 1)), float(np.nan_to_num(usual))


def _of_one(points: Array, index: int, mended: Array) -> float:
    """Median deviation of the distances of one feature, if it were at ``mended (epoch, 3)``."""
    distance = np.linalg.norm(points - mended[:, None], axis=-1)
    distance[:, index] = np.nan
    return float(np.nan_to_num(_median(_median(np.abs(distance - _median(distance, 0)), 0), 0)))


def _loose(tracks: Tracks, points: Array, lines: IntArray) -> list[str]:
    """Features, or the epochs of features, that are not rigid with the rest."""
    (each, usual), size = _typical(points), _size(points)
    if usual > _SOFT * size:
        said = f"distances between features vary by {usual:.3g} m, of a body of {size:.3g} m"
        why = f"{tracks.source}: {said}: this is not one rigid body{_column(points)}"
        return [Refusal(why)]
    if len(points) < _FEW:
        return []
    limit, told = _FAR * max(usual, 1e-9 * size), []
    for index in np.flatnonzero(each > limit).tolist():
        said = f"{tracks.features[index]} is not rigid with the rest: its distances vary by"
        rest = f"{each[index]:.3g} m, those of others by {usual:.3g} m{_axes(points, index, limit)}"
        told.append(f"{tracks.source}: {said} {rest}")
    off = _median(_deviations(points), 2)
    for index in np.flatnonzero((off > 3 * limit).any(0) & (each <= limit)).tolist():
        epochs = np.flatnonzero(off[:, index] > 3 * limit)
        said = f"{tracks.features[index]} is off the rest by {off[epochs, index].max():.3g} m here"
        more = f" and in {epochs.size - 1} further epochs" if epochs.size > 1 else ""
        told.append(f"{tracks.source}:{lines[epochs[0]]}: {said}{more}")
    return told


def _size(points: Array) -> float:
    """Typical distance of features from their mean."""
    seen = ~np.isnan(points)
    mean = np.sum(points, axis=1, where=seen) / np.maximum(seen.sum(1), 1)
    distance = np.linalg.norm(points - mean[:, None], axis=-1)
    return float(np.median(distance[~np.isnan(distance)])) if seen.any() else 0.0


def _column(points: Array) -> str:
    """Which column in another unit would make the whole rigid."""
    for axis, name in enumerate(POINT):
        for factor in (1e-3, 1e3):
            scaled = points * np.where(np.arange(3) == axis, factor, 1.0)
            if _typical(scaled)[1] < 0.1 * _SOFT * _size(scaled):
                return f"; with {name} times {factor:g} it would be: is its unit right?"
    return "; is a column another quantity, or do features exchange their names?"


def _axes(points: Array, index: int, limit: float) -> str:
    """Which exchange or sign of axes of one feature would make it rigid with the rest."""
    for words, mended in _exchanges(points[:, index]):
        if _of_one(points, index, mended) < limit:
            return f"; with {words} it would be: mend these rows"
    return ""


def _exchanges(values: Array) -> Iterator[tuple[str, Array]]:
    for order in list(permutations(range(3)))[1:]:
        yield f"its columns in the order {', '.join(POINT[i] for i in order)}", values[:, order]
    for axis, name in enumerate(POINT):
        yield f"the sign of its {name} changed", values * np.where(np.arange(3) == axis, -1.0, 1.0)
