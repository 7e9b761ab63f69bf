"""What several problems estimate, and their errors."""

from debrisest.quantity import POINT, TIME, TIME_VECTOR, Quantity, with_sigmas

_ESTIMATED = {
    "rate_b": Quantity(TIME_VECTOR, "rad/s", "estimated angular rate in principal axes"),
    "point_b": Quantity((*TIME, "feature", "axis"), "m", "estimated features in body axes"),
    "position": Quantity(
        TIME_VECTOR, "m", "target relative to the chaser; assess: norm of the error", "m"
    ),
    "velocity": Quantity(
        TIME_VECTOR, "m/s", "target's relative velocity; assess: norm of the error", "m/s"
    ),
    "start_point_b": Quantity(POINT, "m", "first guess of the features in body axes"),
}

QUANTITIES = {
    **with_sigmas(_ESTIMATED),
    "attitude": Quantity(TIME, "rad", "angle of the attitude error", "deg"),
    "rate": Quantity(TIME, "rad/s", "norm of the rate error", "deg/s"),
    "position_error": Quantity(TIME_VECTOR, "m", "error of the position"),
    "velocity_error": Quantity(TIME_VECTOR, "m/s", "error of the velocity"),
    "rate_error": Quantity(TIME_VECTOR, "rad/s", "error of the rate"),
}
