"""Estimates in the feature frame as seen from the principal axes ``b``, to first order.

Where two moments are equal, their axes are undefined, and so are the rates about them: the standard
deviations are huge.
"""

import numpy as np

from debrisest.arrays import Array, Data, IntArray
from debrisest.assessment.principal_axes import best_relabeling
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.problems.tumbling import points_motion as body
from debrisest.problems.tumbling.points_inertia import log_tensor, principal_logs

_SIDES = ((2, 1), (0, 2), (1, 0))
"""Elements of an antisymmetric matrix that are the components of its vector."""

_LEAST_GAP = 1e-9
"""Moments nearer to each other than this share are equal."""


def in_principal_axes(state: Array) -> Data:
    """Return ``q_ib``, ``q_bf``, ``rate_b`` and ``moments_b`` of states (run, time, 12).

    The axes of a run keep their labels: they are those nearest to the axes of its last epoch.
    """
    inertia = state[..., body.LOG_INERTIA]
    rows, which = _distinct(inertia)
    logs, axes = principal_logs(inertia.reshape(-1, 5)[rows])
    last = axes[which[rows // state.shape[1], -1]]
    labels = best_relabeling(axes, last)
    axes = axes @ np.swapaxes(labels, -1, -2)
    logs = (np.abs(labels) @ logs[..., None])[..., 0]
    q_fb = quaternion.from_matrix(axes)
    moments = np.exp(logs)
    q_fb = np.where(np.isnan(logs[..., :1]), np.nan, q_fb)
    turn = quaternion.to_matrix(q_fb)
    return {
        "q_ib": quaternion.multiply(state[..., body.Q], q_fb[which]),
        "q_bf": quaternion.conjugate(q_fb)[which],
        "rate_b": (state[..., None, body.RATE] @ turn[which])[..., 0, :],
        "moments_b": (moments / np.linalg.norm(moments, axis=-1, keepdims=True))[which],
    }


def _distinct(values: Array) -> tuple[IntArray, IntArray]:
    """Return rows of values (..., time, n) that are not as before, and which of them each is."""
    new = np.ones(values.shape[:-1], dtype=np.bool_)
    new[..., 1:] = np.any(values[..., 1:, :] != values[..., :-1, :], axis=-1)
    return np.flatnonzero(new), (np.cumsum(new) - 1).reshape(new.shape)


def axes_by_inertia(data: Data) -> tuple[Array, Array]:
    """Return how ``b`` turns, in ``b``, and how the logs of the moments change, each (..., 3, 5).

    Both are derivatives by the five coordinates of the inertia.
    """
    rows, which = _distinct(np.concatenate([data["q_bf"], data["moments_b"]], axis=-1))
    q_bf = data["q_bf"].reshape(-1, 4)[rows]
    axes = np.swapaxes(quaternion.to_matrix(q_bf), -1, -2)[..., None, :, :]
    turned = np.swapaxes(axes, -1, -2) @ log_tensor(np.eye(5)) @ axes
    logs = np.log(data["moments_b"].reshape(-1, 3)[rows])
    gaps = [logs[..., j] - logs[..., i] for i, j in _SIDES]
    apart = [np.copysign(np.maximum(np.abs(gap), _LEAST_GAP), gap)[..., None] for gap in gaps]
    turn = [turned[..., i, j] / gap for (i, j), gap in zip(_SIDES, apart)]
    moved = np.swapaxes(np.diagonal(turned, 0, -2, -1), -1, -2)
    return np.stack(turn, axis=-2)[which], moved[which]


def rate_by_errors(data: Data) -> Array:
    """Return the derivative (..., 3, 11) of ``rate_b`` by the errors in the feature frame."""
    turn, _ = axes_by_inertia(data)
    result = np.zeros((*turn.shape[:-1], 11))
    result[..., body.RATE_ERROR] = quaternion.to_matrix(data["q_bf"])
    result[..., body.INERTIA_ERROR] = matrix_of_cross(data["rate_b"]) @ turn
    return result


def sigmas(data: Data, sigma: Array) -> Data:
    """Return the standard deviations of the four estimates from those (..., 11) of the errors.

    As if the errors were uncorrelated.
    """
    turn, logs = axes_by_inertia(data)
    attitude = np.zeros((*turn.shape[:-1], 11))
    attitude[..., body.TURN_ERROR] = np.swapaxes(quaternion.to_matrix(data["q_ib"]), -1, -2)
    attitude[..., body.INERTIA_ERROR] = turn
    moments = data["moments_b"]
    share = (moments**2)[..., None, :] @ logs
    return {
        "q_ib_sigma": _spread(0.5 * _right(data["q_ib"]) @ attitude, sigma),
        "q_bf_sigma": _spread(
            0.5 * _right(quaternion.conjugate(data["q_bf"])) @ turn, sigma[..., body.INERTIA_ERROR]
        ),
        "rate_b_sigma": _spread(rate_by_errors(data), sigma),
        "moments_b_sigma": _spread(
            moments[..., None] * (logs - share), sigma[..., body.INERTIA_ERROR]
        ),
    }


def _right(q: Array) -> Array:
    """Matrix (..., 4, 3) of ``q * (0, v)``."""
    matrix = q[..., :1, None] * np.eye(3) + matrix_of_cross(q[..., 1:])
    return np.concatenate([-q[..., None, 1:], matrix], axis=-2)


def _spread(derivative: Array, sigma: Array) -> Array:
    return np.asarray(np.sqrt((derivative**2 @ (sigma**2)[..., None])[..., 0]))
