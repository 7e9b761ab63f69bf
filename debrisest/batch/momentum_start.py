"""Inertia and angular momentum from local rates: a start without signs, grids or truth.

The angular momentum is constant in inertial axes: ``(1 + sum p_k S_k) w = R^T h`` is linear in the
five numbers ``p`` of the inertia and in ``h``, whose scale is that of the inertia.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.batch.descent import Prior
from debrisest.batch.local_rates import Local
from debrisest.dynamics import log_inertia

_PRIOR = 0.5  # of each p
_REWEIGHTINGS = 6
_LEAST_MOMENT, _LARGEST_MOMENT = 0.02, 1.7  # of a body whose moments add up to 3
_STEP = 1e-5  # of each p
_SHARE_OF_TURN = 0.05  # rad, error of a window's attitude against which its rate is weighed


def inertia_start(local: Local) -> Prior:
    """Return the log-ratios of the inertia from the conservation of angular momentum.

    Their information is that of the windows at the momentum that suits them best.
    """
    back = np.swapaxes(quaternion.to_matrix(local.q), -1, -2)
    turned = np.moveaxis(log_inertia.BASIS @ local.rate[:, None, :, None], 1, 2)[..., 0]
    rows = np.concatenate([turned, -back], axis=-1)
    speed2 = np.sum(local.rate**2, axis=-1)
    variance = np.trace(local.covariance, axis1=-2, axis2=-1) / 3.0 + _SHARE_OF_TURN**2 * speed2
    robust, solution = np.ones(len(rows)), np.zeros(8)
    for _ in range(_REWEIGHTINGS):
        weight = (robust / variance)[:, None, None]
        back_rows = np.swapaxes(rows, -1, -2)
        hold = np.sum(back_rows @ (weight * rows), axis=0)
        pull = -np.sum(back_rows @ (weight * local.rate[..., None]), axis=0)[:, 0]
        hold[range(5), range(5)] += _PRIOR**-2
        solution = np.linalg.lstsq(hold, pull, rcond=1e-12)[0]
        residual = (rows @ solution) + local.rate
        robust = 1.0 / (1.0 + np.sum(residual**2, axis=-1) / (9.0 * variance))
    tensor = _of_a_body(solution[:5])
    to_p = np.linalg.inv(_by_p(tensor))
    information = np.linalg.inv(np.linalg.inv(hold)[:5, :5])
    return Prior(log_inertia.log_ratios(tensor), to_p.T @ information @ to_p)


def _by_p(tensor: Array) -> Array:
    """Derivative (5, 5) of the log-ratios by ``p``."""
    ends = [log_inertia.log_ratios(tensor + side * log_inertia.BASIS) for side in (_STEP, -_STEP)]
    return np.asarray((ends[0] - ends[1]).T / (2.0 * _STEP))


def _of_a_body(p: Array) -> Array:
    """Inertia (3, 3) of ``p``, drawn to equal moments until a body can have it."""
    for _ in range(100):
        tensor = np.eye(3) + np.tensordot(p, log_inertia.BASIS, 1)
        moments = np.linalg.eigvalsh(tensor)
        if moments[0] > _LEAST_MOMENT and moments[-1] < _LARGEST_MOMENT / 3.0 * moments.sum():
            return np.asarray(tensor)
        p = 0.9 * p
    return np.eye(3)
