"""Motion of a tumbling body from tracked points, attitudes or rates: the calls of this package.

No simulation, start or tuning is needed. Times are in seconds and increase; they need not be
evenly spaced, but the body should turn less than half a turn between most of them.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.attitude import quaternion
from debrisest.batch.align_clouds import align_clouds
from debrisest.batch.arc import Arc, course
from debrisest.batch.attitudes import Attitudes
from debrisest.batch.free_points import FreePoints
from debrisest.batch.local_rates import local_rates
from debrisest.batch.motion import Motion, Status
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.rates import Rates
from debrisest.batch.rigid_sets import (
    largest_rigid_set,
    noise_of,
    odd_points,
    on_known_body,
    other_body,
    pairs,
)
from debrisest.batch.solve import Solution, solve
from debrisest.batch.tracks import Tracks, tracks

_LEAST_NOISE = 1e-6  # rad, rad/s, or the share of a body's size, of noise that is not given
_FEWEST_LEFT = 4  # points of a known body, once some were left out


def estimate_from_points(
    times: Array,
    points: Array,
    sigma: Array | float | None,
    model: Array | None = None,
    near: Arc | None = None,
    at: Array | None = None,
) -> Motion:
    """Return the motion of the body that most of the tracked points belong to.

    ``points (time, feature, 3)``, m, in inertially fixed axes from any origin at each epoch, NaN
    where not seen; ``sigma``, m, one number, (time, feature) or (time, feature, 3), or None where
    it is to be found; ``model (feature, 3)``, m, places in the feature frame, None if unknown;
    ``near`` an arc close to the motion, such as that of fewer epochs, which saves the search;
    ``at`` the times, s, at which the motion is told, where these are not ``times``.
    """
    given = None if sigma is None else tracks(times, points, sigma)
    return estimate_from_tracks(tracks(times, points, 1.0), given, model, near, at)


def estimate_from_tracks(
    plain: Tracks,
    given: Tracks | None,
    model: Array | None = None,
    near: Arc | None = None,
    at: Array | None = None,
) -> Motion:
    """Return the same of tracks with unit weights and with those of their noise, if it is given."""
    times, found = plain.times, pairs(plain, model)
    typical = noise_of(found) if given is None else _typical(given)
    if given is None:
        typical = np.nanmax(
            [typical, _LEAST_NOISE * np.nanmax(np.abs(plain.centred()), initial=0.0)]
        )
    if not (np.isfinite(typical) and typical > 0.0):
        typical = 1.0
    scale = float(np.nanmax([typical, noise_of(found)]))
    kept = (largest_rigid_set if model is None else on_known_body)(found, scale)
    other = other_body(found, scale, kept)
    tracked = (given or plain.scaled(typical)).without(~kept)
    tracked = tracked.within(tracked.seen.sum(axis=1) >= 2)
    unit = typical if given is None else 1.0
    whole, tracked = tracked, tracked.without(odd_points(tracked, found, scale))
    tracked = tracked.within(tracked.seen.sum(axis=1) >= 2)
    at = times if at is None else at
    if model is not None:
        solution = _model_in_doubt(
            solve(KnownPoints(tracked, model), at, given is not None, near=near), plain
        )
        return _with_points(solution, plain, whole, other, unit)
    cloud = align_clouds(tracked)
    all_points = FreePoints(tracked, cloud.model)
    joined = cloud.tracks.seen.any(axis=0)
    wider = None if np.array_equal(joined, tracked.seen.any(axis=0)) else all_points
    solution = solve(cloud, at, given is not None, wider)
    return _with_points(solution, plain, whole, other, unit)


def estimate_from_attitudes(
    times: Array,
    q: Array,
    sigma: Array | float | None = None,
    near: Arc | None = None,
    at: Array | None = None,
) -> Motion:
    """Return the motion of a body from measured ``q_if (time, 4)``, NaN where there is none.

    ``sigma``, rad, one number or (time,); or a covariance (time, 3, 3), rad^2, in inertial axes;
    or None where it is to be found. ``near`` and ``at`` are as for points.
    """
    seen = np.asarray(np.isfinite(q).all(axis=-1))
    information = _information(len(times), 1.0 if sigma is None else sigma, seen)
    evidence = Attitudes(times[seen], quaternion.normalize(q[seen]), information[seen])
    unit = 1.0
    if sigma is None:
        unit = max(_noise_of_windows(evidence), _LEAST_NOISE)
        evidence = evidence.scaled(unit)
    solution = solve(evidence, times if at is None else at, sigma is not None, near=near)
    return _without_points(solution, times, unit)


def estimate_from_rates(
    times: Array,
    rate: Array,
    sigma: Array | float | None = None,
    near: Arc | None = None,
    at: Array | None = None,
) -> Motion:
    """Return the motion of a body from measured rates (time, 3), rad/s, in axes fixed in it.

    ``sigma``, rad/s, as for attitudes, a covariance in body axes. No attitude is measured: that at
    the arc's epoch is what the rates add up to from the first epoch, and its sigma there is zero.
    ``near`` and ``at`` are as for points.
    """
    seen = np.asarray(np.isfinite(rate).all(axis=-1))
    information = _information(len(times), 1.0 if sigma is None else sigma, seen)
    evidence = Rates(times[seen], rate[seen], information[seen])
    unit = 1.0
    if sigma is None:
        unit = max(_noise_of_windows(evidence), _LEAST_NOISE)
        evidence = evidence.scaled(unit)
    solution = solve(evidence, times if at is None else at, sigma is not None, near=near)
    return _without_points(solution, times, unit)


def _model_in_doubt(solution: Solution, plain: Tracks) -> Solution:
    """Return the solution; not accepted where too few points are left to say which were wrong."""
    together = plain.within(plain.seen.sum(axis=1) >= 2).seen.any(axis=0)
    assert isinstance(solution.evidence, KnownPoints)
    left = solution.evidence.tracks.seen.any(axis=0)
    few = left.sum() < min(_FEWEST_LEFT, together.sum())
    return (
        solution._replace(status=Status.MODEL_IN_DOUBT)
        if few and solution.status.accepted
        else solution
    )


def _typical(given: Tracks) -> float:
    """Root mean square of the given sigma over what is seen, m."""
    used = given.weight[given.weight > 0.0]
    return float(np.sqrt(np.mean(1.0 / used))) if len(used) else 1.0


def _information(count: int, sigma: Array | float, seen: BoolArray) -> Array:
    sigma = np.asarray(sigma, dtype=np.float64)
    if sigma.ndim == 3:
        covariance = np.where(seen[:, None, None], sigma, np.eye(3))
        return np.where(seen[:, None, None], np.linalg.inv(covariance), 0.0)
    variance = np.broadcast_to(sigma**2, (count,))
    return np.where(seen[:, None, None], np.eye(3) / variance[:, None, None], 0.0)


def _noise_of_windows(evidence: Attitudes | Rates) -> float:
    local = local_rates(evidence.times, evidence.seen())
    return 1.0 if local is None else max(local.noise, 1e-12)


def _with_points(
    solution: Solution, plain: Tracks, tracked: Tracks, other: BoolArray, unit: float
) -> Motion:
    """Return the motion with places of points and which observations count."""
    evidence = solution.evidence
    assert isinstance(evidence, KnownPoints | FreePoints)
    kept = np.asarray(evidence.tracks.seen.any(axis=0))
    used = np.zeros(plain.seen.shape, dtype=bool)
    used[np.searchsorted(plain.times, evidence.times)] = evidence.tracks.seen
    sigma = np.zeros_like(evidence.model)
    if isinstance(evidence, FreePoints) and solution.arc is not None:
        motion = course(solution.arc, evidence.times)
        spread = evidence.covariance(motion, solution.covariance)
        sigma = np.sqrt(np.diagonal(spread, 0, -2, -1))
    elif isinstance(evidence, FreePoints):
        sigma = np.sqrt(np.diag(evidence.inverse_laplacian))[:, None] * np.ones(3) * solution.noise
    return _motion(
        solution,
        np.where(kept[:, None], evidence.model, np.nan),
        np.where(kept[:, None], sigma, np.nan),
        kept,
        other,
        used,
        float(1.0 - used.sum() / max(tracked.seen[:, kept].sum(), 1)),
        unit,
    )


def _without_points(solution: Solution, times: Array, unit: float) -> Motion:
    used = np.zeros(len(times), dtype=bool)
    counted = solution.evidence.dof > 0.0
    used[np.searchsorted(times, solution.evidence.times)] = counted
    share = float(1.0 - np.mean(counted)) if len(counted) else 0.0
    nothing, none = np.zeros((0, 3)), np.zeros(0, dtype=bool)
    return _motion(solution, nothing, nothing, none, none, used, share, unit)


def _motion(
    solution: Solution,
    points: Array,
    points_sigma: Array,
    kept: BoolArray,
    other: BoolArray,
    used: BoolArray,
    rejected: float,
    unit: float,
) -> Motion:
    return Motion(
        status=solution.status,
        judged=solution.judged,
        path=solution.path,
        arc=solution.arc,
        covariance=solution.covariance,
        spread=solution.spread,
        fit=solution.fit,
        holds=solution.holds,
        noise=solution.noise * unit,
        points=points,
        points_sigma=points_sigma,
        kept=kept,
        other_body=other,
        used=used,
        rejected=rejected,
        evidence=solution.evidence,
        local=solution.local,
        wander=solution.wander,
    )
