"""Clouds of points of unknown places laid over each other, without any dynamics.

An epoch that shares points with many others is the first cloud. Attitudes of the epochs that share
three points with it, and places of all points of these epochs at these attitudes, follow in turn
(generalised Procrustes analysis) until the cloud has grown to all that hangs together.
"""

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.batch.free_points import FreePoints
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.tracks import Tracks

_ROUNDS = 60
_CANDIDATES = 300  # epochs that may be the first cloud
_NEARLY = 0.8  # of the most epochs that share points with one
_CAUCHY = 9.0
_FARTHEST = 100.0  # steps at once
_ENOUGH = 0.2  # of the points' standard deviation, the change at which the cloud is at rest


def align_clouds(tracks: Tracks) -> FreePoints:
    """Return the tracks with places of the points; those that hang on nothing have no weight.

    They can join once a law of motion tells the attitude of all epochs.
    """
    if not len(tracks.times):
        return FreePoints(tracks, np.zeros((tracks.weight.shape[1], 3)))
    first = _first_cloud(tracks)
    model, known = tracks.centred()[first], tracks.seen[first]
    robust, passed = tracks.weight, [model]
    for _ in range(_ROUNDS):
        q = _attitudes(tracks._replace(weight=np.where(known, robust, 0.0)), model)
        told = np.isfinite(q[:, 0])
        cloud = FreePoints(Tracks(*(part[told] for part in tracks._replace(weight=robust))), model)
        if not told.any():
            break
        settled = cloud.settled(q[told])
        now = settled.tracks.weight.sum(axis=0) > 0.0
        change = _change(cloud, settled.model, model, known & now)
        robust = _robust(tracks, settled.model, q, told)
        same = np.array_equal(now, known)
        model, known = settled.model, now
        if same and change < _ENOUGH:
            break
        passed = [*passed, model] if same else [model]
        if len(passed) == 3:
            model = ahead(*passed)
            passed = [model]
    return FreePoints(tracks._replace(weight=np.where(known, tracks.weight, 0.0)), model)


def _attitudes(tracks: Tracks, model: Array) -> Array:
    """Return attitudes (time, 4), NaN where an epoch does not tell all three directions."""
    if not compiled.available():
        return KnownPoints(tracks, model).seen().q
    from debrisest.batch import free_points_loops

    seen = tracks.points, tracks.weight, model
    return free_points_loops.attitudes(*map(np.ascontiguousarray, seen))


def ahead(first: Array, second: Array, third: Array) -> Array:
    """Return where models of three rounds lead, whose steps shrink slowly (Varadhan, Roland 2008).

    Clouds that hang together by few points come to rest like 0.986 to the power of the rounds.
    """
    step = second - first
    bend = third - second - step
    length = np.linalg.norm(step) / max(float(np.linalg.norm(bend)), 1e-300)
    factor = np.clip(length, 1.0, _FARTHEST)
    return np.asarray(first + 2.0 * factor * step + factor**2 * bend)


def _first_cloud(tracks: Tracks) -> int:
    """Return the epoch that shares three points with most others; of such, the widest cloud."""
    seen = tracks.seen.astype(np.float64)
    stride = -(-len(seen) // _CANDIDATES)
    shared = np.sum(seen[::stride] @ seen.T >= 3.0, axis=1)
    spread = np.where(shared >= _NEARLY * shared.max(), _spread(tracks)[::stride], -1.0)
    return int(np.argmax(spread)) * stride


def _spread(tracks: Tracks) -> Array:
    """Second largest moment of the points of each epoch, which a line has not (time,)."""
    centred = tracks.centred() * np.sqrt(tracks.weight)[..., None]
    return np.asarray(np.linalg.eigvalsh(np.swapaxes(centred, -1, -2) @ centred)[:, 1])


def _robust(tracks: Tracks, model: Array, q: Array, told: Array) -> Array:
    """Weights (time, feature), less for points that are far off (Cauchy)."""
    attitude = np.where(told[:, None], q, [1.0, 0.0, 0.0, 0.0])
    if compiled.available():
        from debrisest.batch import free_points_loops

        seen = tracks.points, tracks.weight, model, attitude
        square = free_points_loops.residual_squares(*map(np.ascontiguousarray, seen))[0]
    else:
        residual = np.nan_to_num(KnownPoints(tracks, model).residuals(attitude))
        square = np.sum(residual**2, axis=-1) * tracks.weight
    weight = tracks.weight / (1.0 + square / _CAUCHY)
    return np.where(told[:, None], weight, tracks.weight)


def _change(cloud: FreePoints, after: Array, before: Array, both: Array) -> float:
    """Largest change of places, in standard deviations, whatever the cloud's frame does."""
    if both.sum() < 3:
        return np.inf
    new, old = after[both], before[both]
    new, old = new - new.mean(axis=0), old - old.mean(axis=0)
    moved = np.linalg.norm(new - old, axis=-1)
    sigma = np.sqrt(np.diag(cloud.inverse_laplacian)[both])
    return float(np.max(moved / np.maximum(sigma, 1e-300)))
