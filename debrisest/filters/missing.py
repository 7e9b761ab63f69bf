"""Components that were not observed."""

import numpy as np

from debrisest.arrays import Array, BoolArray


def drop_missing(
    measured: BoolArray, innovation: Array, response: Array, noise: Array
) -> tuple[Array, Array, Array]:
    """Take the components that were not measured out of an update, keeping the shapes.

    `measured` (..., m), `innovation` (..., m), `response` (..., j, m) the deviations of j sigma
    points (or a transposed measurement Jacobian), `noise` (m, m) or (..., m, m).
    A missing component gets zero innovation and response and an uncorrelated noise of one: the
    innovation covariance is then block diagonal, the gain's column zero, and the update is the one
    without that row, whatever stood there (NaN included).
    """
    both = measured[..., :, None] & measured[..., None, :]
    return (
        np.where(measured, innovation, 0.0),
        np.where(measured[..., None, :], response, 0.0),
        np.where(both, noise, np.eye(measured.shape[-1])),
    )
