"""What is estimated of a piece of debris, and the errors."""

from debrisest.quantity import RUN_VECTOR, TIME, TIME_VECTOR, Quantity, with_sigmas

_TIME_OBSERVER = (*TIME, "observer")
_COMPANION = ("run", "companion", "axis")

_ESTIMATED = {
    "start_orbit_position": Quantity(RUN_VECTOR, "m", "first guess of the debris' position"),
    "start_orbit_velocity": Quantity(RUN_VECTOR, "m/s", "first guess of the debris' velocity"),
    "start_companion_position": Quantity(_COMPANION, "m", "first guess of the pieces beside it"),
    "start_companion_velocity": Quantity(_COMPANION, "m/s", "first guess of their velocity"),
    "start_attitude_bias": Quantity(
        ("run", "observer", "axis"), "rad", "first guess of the error of the known attitude"
    ),
    "debris_position": Quantity(TIME_VECTOR, "m", "estimated position, Earth-centred inertial"),
    "debris_velocity": Quantity(TIME_VECTOR, "m/s", "estimated velocity, Earth-centred inertial"),
    "attitude_bias": Quantity(
        (*_TIME_OBSERVER, "axis"), "rad", "estimated error of the known attitude, camera axes"
    ),
}

QUANTITIES = {
    **with_sigmas(_ESTIMATED),
    "debris_position_error": Quantity(TIME_VECTOR, "m", "error of debris_position"),
    "pixel": Quantity(TIME, "px", "how far the debris is from where it is expected", "px"),
    "lost": Quantity(TIME, "1", "1 where pixel is above 10 px, else 0", "1"),
    "far": Quantity(TIME, "1", "1 where the position error is above 5 km, else 0", "1"),
    "position_spread": Quantity(TIME, "m", "root of the trace of the position's covariance", "km"),
    "covariance_trace": Quantity(
        TIME, "m2", "trace of the covariance of position, m^2, and velocity, m^2/s^2", "km2"
    ),
    "bias_error": Quantity(TIME, "rad", "root mean square error of attitude_bias", "mrad"),
}
