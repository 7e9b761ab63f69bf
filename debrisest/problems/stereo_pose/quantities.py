"""What is estimated of a target before two cameras, and the errors."""

from debrisest.quantity import RUN_VECTOR, TIME, TIME_QUATERNION, TIME_VECTOR, Quantity, with_sigmas

AXIS_LENGTH = {"ratio": 2}

_TIME_RATIO = (*TIME, "ratio")

_ESTIMATED = {
    "start_position": Quantity(RUN_VECTOR, "m", "first guess of the position"),
    "start_velocity": Quantity(RUN_VECTOR, "m/s", "first guess of the velocity"),
    "start_rate_l": Quantity(RUN_VECTOR, "rad/s", "first guess of the rate"),
    "start_q_lt": Quantity(("run", "quaternion"), "1", "first guess of the attitude"),
    "start_inertia_ratio": Quantity(("run", "ratio"), "1", "first guess of the inertia ratios"),
    "q_lt": Quantity(TIME_QUATERNION, "1", "estimated attitude, target to leader's frame"),
    "rate_l": Quantity(TIME_VECTOR, "rad/s", "estimated rate relative to the leader's frame"),
    "inertia_ratio": Quantity(_TIME_RATIO, "1", "estimated ln(Ix/Iy) and ln(Iy/Iz)"),
}

QUANTITIES = {
    **with_sigmas(_ESTIMATED),
    "inertia_ratio_error": Quantity(_TIME_RATIO, "1", "error of the inertia ratios"),
    "k1": Quantity(TIME, "1", "error of ln(Ix/Iy), absolute", "1"),
    "k2": Quantity(TIME, "1", "error of ln(Iy/Iz), absolute", "1"),
}
