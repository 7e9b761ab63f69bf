"""Second stage: hold the Euler angles that the first stage ended with.

Source: Li et al., Eqs 32-37. Printed Eq 34 differentiates ``R_1^-1`` with respect to the body rate;
it is the derivative with respect to the angles.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import euler
from debrisest.control.model_error import state_function
from debrisest.control.pixel_tracking import Demand
from debrisest.control.rigid_spacecraft import Spacecraft, turned
from debrisest.control.robust_term import Gains, Reading, Uncertainty, robust_term

GAINS = Gains(
    proportional=np.full(3, 10.0),
    damping=np.full(3, 1.0),
    robustness=np.full(3, 0.001),
    boundary=np.full(3, 0.2),
)
"""Table 2; the boundary is ours."""


def hold_attitude(
    craft: Spacecraft,
    gains: Gains,
    uncertainty: Uncertainty,
    reading: Reading,
    desired: Array,
    angles: Array,
    rate_b: Array,
    integral: Array,
) -> Demand:
    """Torque ``(..., 3)`` that holds the angles ``desired (..., 3)``, rad.

    ``angles`` and ``rate_b`` are as measured, ``integral (..., 3)`` that of the error so far.
    """
    drift = state_function(craft, angles, rate_b)
    error, error_rate = desired - angles, -euler.rates(angles, rate_b)
    feedback = gains.proportional * error + gains.damping * error_rate - drift
    surface = gains.proportional * integral + gains.damping * error + error_rate
    wanted = feedback + robust_term(reading, feedback, drift, surface, gains, uncertainty)
    return Demand(turned(craft.inertia, euler.body_rate(angles, wanted)), error)
