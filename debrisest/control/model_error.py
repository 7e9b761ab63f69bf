"""How far spacecraft are from the controller's model of them: what F and D of the law must bound.

Source: Li et al., Sec. V, where both are found by Monte Carlo simulation of the errors: F is 0.1 of
the state function and D 0.4 of the unit matrix, of the second stage, whose outputs are the Euler
angles. All arrays have the batch axes (..., satellite).
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import euler
from debrisest.control.rigid_spacecraft import Spacecraft, turned


def state_function(craft: Spacecraft, angles: Array, rate_b: Array) -> Array:
    """``L_f^2 h_3 (..., 3)``: second derivative of the angles, rad/s^2, without a torque."""
    free = euler.rates(angles, craft.acceleration(rate_b))
    return np.asarray(euler.rates_change(angles, rate_b) + free)


def gain_mismatch(
    model: Spacecraft, plant: Spacecraft, delivered: Array | float, angles: Array, measured: Array
) -> Array:
    """Largest entry (...) of ``B B_model^-1 - I``.

    B is the matrix from torques to the second derivative of the angles.
    ``delivered (..., 3)`` is the share of a torque that acts, ``angles`` are the true ones and
    ``measured`` those that the model is given.
    """
    columns = []
    for wanted in np.eye(3):
        torque = turned(
            model.inertia, euler.body_rate(measured, np.broadcast_to(wanted, angles.shape))
        )
        columns.append(euler.rates(angles, turned(plant.inverse, delivered * torque)))
    return np.asarray(np.abs(np.stack(columns, -1) - np.eye(3)).max(axis=(-2, -1)))


def drift_mismatch(
    model: Spacecraft, plant: Spacecraft, true: tuple[Array, Array], measured: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Error of the modelled state function, and that function ``(..., 3)``, of angles and rates."""
    modelled = state_function(model, *measured)
    return state_function(plant, *true) - modelled, modelled
