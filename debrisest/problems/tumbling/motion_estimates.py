"""Motions of runs as the estimates of all epochs, and what follows from them at the last one."""

from collections.abc import Sequence

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.batch.arc import INERTIA, RATE, TURN, UNKNOWNS, moved
from debrisest.batch.derived import LOOSEST_AXIS, derived
from debrisest.batch.motion import Motion
from debrisest.batch.observability import lost_directions
from debrisest.batch.online import Stretch
from debrisest.batch.path import Path
from debrisest.dynamics.log_inertia import BASIS
from debrisest.filters.estimates import Estimates

_TO_PLAIN = BASIS[:, [0, 1, 0, 0, 1], [0, 1, 1, 2, 2]].T
"""The coordinates of `points_inertia` (5,) by the orthonormal ones of the batch (5,)."""
_ALL_FIVE = 5.0
_FEWEST_POINTS = 2
"""Of an epoch: a single point tells nothing of a body that moves as it likes."""


def estimates(
    runs: Sequence[Sequence[Stretch]], times: Array, measured: Array, kept: Sequence[int]
) -> Estimates:
    """Return the record of all runs that ``measured (run, time, m)``, each of some stretches.

    The covariances are those at the epochs ``kept``; the figures are those of the last stretch.
    """
    states, sigmas, covariances = zip(*(_of_run(run, times, kept) for run in runs))
    motions = [run[-1].motion for run in runs]
    shape = (len(motions), len(times))
    figures = [
        _figures(motion) | _counted(motion, m) | _at_end(motion, times)
        for motion, m in zip(motions, measured)
    ]
    return Estimates(
        *(np.stack(states), np.stack(sigmas), np.stack(covariances)),
        kept=np.array(kept, dtype=np.int64),
        nis=np.full(shape, np.nan),
        nis_dof=np.zeros(shape, dtype=np.int64),
        status=np.array([_said(motion) for motion in motions]),
        counts={name: np.stack([one[name] for one in figures]) for name in figures[0]},
    )


def _of_run(
    stretches: Sequence[Stretch], times: Array, kept: Sequence[int]
) -> tuple[Array, Array, Array]:
    """State (time, 12), sigma (time, 11) and covariances (kept, 11, 11) in plain coordinates."""
    state = np.full((len(times), UNKNOWNS + 1), np.nan)
    covariance = np.full((len(times), UNKNOWNS, UNKNOWNS), np.nan)
    for motion, path in stretches:
        at = np.searchsorted(times, path.times)
        state[at], covariance[at] = _states(motion, path), _along(motion, path)
    variance = np.diagonal(covariance, 0, -2, -1)
    sigma = np.sqrt(np.where(variance < 0.0, 0.0, variance))
    return state, sigma, covariance[list(kept)]


def _states(motion: Motion, path: Path) -> Array:
    inertia = np.full(5, np.nan)
    if motion.arc is not None and motion.status.accepted:
        inertia = _TO_PLAIN @ motion.arc.log_inertia
    constant = np.broadcast_to(inertia, (len(path.times), 5))
    return np.concatenate([path.q, path.rate, constant], axis=-1)


def _along(motion: Motion, path: Path) -> Array:
    """Covariance (time, 11, 11) of attitude, rate and inertia; NaN of what is not claimed."""
    if motion.arc is None:
        result = path.joint.copy()
        result[:, TURN, TURN], result[:, RATE, RATE] = path.turn_covariance, path.rate_covariance
        return result
    plain = np.eye(UNKNOWNS)
    plain[INERTIA, INERTIA] = _TO_PLAIN
    return np.asarray(plain @ motion.claim(path.joint) @ plain.T)


def _said(motion: Motion) -> str:
    return f"{motion.status.sentence}; {motion.judged.sentence}"


def _figures(motion: Motion) -> Data:
    """What a run says of itself, by name."""
    lost = lost_directions(motion.claimed) if motion.arc is not None else _ALL_FIVE
    return {
        "accepted": np.asarray(float(motion.status.accepted)),
        "fit": np.asarray(motion.fit.excess if motion.fit is not None else np.nan),
        "lost_directions": np.asarray(float(lost)),
        "rejected_share": np.asarray(motion.rejected),
        "noise_found": np.asarray(motion.noise),
        "holds_from": np.asarray(motion.holds[0]),
        "holds_until": np.asarray(motion.holds[1]),
        **_points(motion),
    }


def _counted(motion: Motion, measured: Array) -> Data:
    """How many of the measurements (time, m) of each epoch count, and how many do not."""
    used = motion.used.reshape(len(measured), -1)
    seen = np.isfinite(measured.reshape(*used.shape, -1)).all(axis=-1)
    alone = (used.shape[1] > 1) & (seen.sum(axis=-1, keepdims=True) < _FEWEST_POINTS)
    return {
        "observations_used": used.sum(axis=-1).astype(np.float64),
        "rejected": (seen & ~used & ~alone).sum(axis=-1).astype(np.float64),
    }


def _points(motion: Motion) -> Data:
    if not len(motion.points):
        return {}
    used = np.asarray(float(motion.kept.sum()))
    points = {"point_f": motion.points, "point_f_sigma": motion.points_sigma}
    return points | {"features_used": used, "on_other_body": motion.other_body.astype(np.float64)}


def _at_end(motion: Motion, times: Array) -> Data:
    """Speed, axes, nutation and moments at the last epoch, NaN where they are undefined."""
    speed, speed_sigma = _speeds(motion.path)
    result = {
        "speed_end": speed[-1],
        "speed_end_sigma": speed_sigma[-1],
        "mean_speed": np.nanmean(speed) if np.isfinite(speed).any() else np.asarray(np.nan),
        "mean_speed_sigma": _of_mean(speed_sigma),
    }
    result |= _undefined() | _spin_axis(motion.path)
    if motion.arc is None or not motion.status.accepted:
        return {name: np.asarray(value, dtype=np.float64) for name, value in result.items()}
    arc = moved(motion.arc, float(times[-1]))
    found = derived(arc, motion.claim(motion.path.joint[-1]))
    result |= {
        "spin_axis_i": found.spin_axis.value,
        "spin_axis_i_sigma": found.spin_axis.sigma,
        "momentum_axis_i": found.momentum.value,
        "momentum_axis_i_sigma": found.momentum.sigma,
        "nutation_angle": found.nutation_angle.value[0],
        "nutation_angle_sigma": found.nutation_angle.sigma[0],
        "nutation_period": found.nutation_period.value[0],
        "nutation_period_sigma": found.nutation_period.sigma[0],
        "moment_share": found.moments.value,
        "moment_share_sigma": found.moments.sigma,
    }
    return {name: np.asarray(value, dtype=np.float64) for name, value in result.items()}


def _spin_axis(path: Path) -> Data:
    """Direction of the rate at the last epoch, inertial, NaN if it may be off by over 10 deg."""
    turn = quaternion.to_matrix(path.q[-1])
    rate = turn @ path.rate[-1]
    by_turn = matrix_of_cross(rate)
    spread = (
        turn @ path.rate_covariance[-1] @ turn.T + by_turn @ path.turn_covariance[-1] @ by_turn.T
    )
    speed = max(float(np.linalg.norm(rate)), np.finfo(float).tiny)
    axis = rate / speed
    across = (np.eye(3) - np.outer(axis, axis)) / speed
    sigma = np.sqrt(np.maximum(np.diag(across @ spread @ across), 0.0))
    sure = np.linalg.norm(sigma) < LOOSEST_AXIS
    return {"spin_axis_i": axis if sure else np.full(3, np.nan), "spin_axis_i_sigma": sigma}


def _undefined() -> Data:
    one, three = np.asarray(np.nan), np.full(3, np.nan)
    names = ("nutation_angle", "nutation_period", "spin_axis_i", "momentum_axis_i", "moment_share")
    shapes = (one, one, three, three, three)
    undefined = dict(zip(names, shapes))
    return undefined | {f"{name}_sigma": value for name, value in undefined.items()}


def _speeds(path: Path) -> tuple[Array, Array]:
    """Length of the rate (time,), rad/s, and its standard deviation."""
    speed = np.linalg.norm(path.rate, axis=-1)
    along = path.rate / np.maximum(speed, 1e-300)[:, None]
    variance = np.einsum("ti,tij,tj->t", along, path.rate_covariance, along)
    return speed, np.sqrt(np.maximum(variance, 0.0))


def _of_mean(sigma: Array) -> Array:
    """Standard deviation of a mean whose errors may be alike at all epochs: the mean of theirs."""
    return np.asarray(np.nanmean(sigma) if np.isfinite(sigma).any() else np.nan)
