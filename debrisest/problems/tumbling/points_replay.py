"""Tracked points of a torque-free body as a `ReplayModel`, which the replay filter wants."""

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.filters.replay_model import ReplayModel
from debrisest.problems.tumbling import points_motion as body
from debrisest.problems.tumbling.points_contrasts import contrasts


def replay_model(known_point_f: Array, seen: BoolArray, noise: float, times: Array) -> ReplayModel:
    """Return the problem of ``seen (run, time, feature)`` points.

    ``known_point_f (run, feature, 3)``, m, in the feature frame; ``noise`` of a coordinate, m;
    ``times (time,)`` of the epochs, s.
    """
    arms = contrasts(known_point_f[:, None], seen)
    return _model(arms, np.arange(len(arms)), noise, times)


def _model(arms: Array, runs: IntArray, noise: float, times: Array) -> ReplayModel:
    rows_of_epoch = 3 * arms.shape[-2]

    def trajectory(state: Array, first: int, last: int) -> tuple[Array, Array]:
        step = 1 if last >= first else -1
        passed = times[np.arange(first, last + step, step)]
        return body.trajectory(state, passed - times[first])

    return ReplayModel(
        trajectory=trajectory,
        rows=lambda states, turning, _, epochs: rows(arms[runs[:, None], epochs], states, turning),
        transition=lambda turning, _, __: transition(turning),
        rewind=lambda state, epoch: body.moved(state, times[0] - times[epoch]),
        chart=_identity,
        inverse_chart=_identity,
        retract=body.retract,
        difference=body.difference,
        plain_difference=body.difference,
        start=lambda prior, _, __: prior,
        sigma=np.full(rows_of_epoch, noise),
        error_names=body.ERROR_NAMES,
        displace=body.displace,
        select=lambda chosen: _model(arms, runs[chosen], noise, times),
    )


def rows(arms: Array, states: Array, turning: Array) -> tuple[Array, Array]:
    """Contrasts ``(run, epoch, m)`` of the points and their derivative ``(run, epoch, m, 11)``.

    ``arms (run, epoch, feature - 1, 3)`` are the contrasts in the feature frame of the epochs of
    ``states (run, epoch, 12)``, and ``turning (run, epoch, 6, 8)`` theirs.
    """
    turn = quaternion.to_matrix(states[..., body.Q])
    shown = arms @ np.swapaxes(turn, -1, -2)
    by_turn = -matrix_of_cross(shown)
    by_rest = by_turn @ turning[:, :, None, :3]
    derivative = np.concatenate([by_turn, by_rest], axis=-1)
    flat = shown.reshape(*shown.shape[:2], 3 * shown.shape[-2])
    return flat, derivative.reshape(*flat.shape, len(body.ERROR_NAMES))


def transition(turning: Array) -> Array:
    """Derivative ``(run, 11, 11)`` of errors by those of the epoch where ``turning`` starts."""
    result = np.zeros((len(turning), 11, 11))
    result[:] = np.eye(11)
    result[:, : body.RATE_ERROR.stop, body.RATE_ERROR.start :] = turning
    return result


def _identity(state: Array) -> Array:
    return np.broadcast_to(np.eye(11), (*state.shape[:-1], 11, 11))
