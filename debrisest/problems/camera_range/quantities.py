"""What is estimated of a target before a camera and a range finder, and the errors."""

from debrisest.quantity import (
    POINT,
    RUN,
    RUN_VECTOR,
    TIME,
    TIME_QUATERNION,
    TIME_VECTOR,
    Quantity,
    with_sigmas,
)

AXIS_LENGTH = {"log_ratio": 5}

_ESTIMATED = {
    "start_relative_position_h": Quantity(RUN_VECTOR, "m", "first guess of the chaser's position"),
    "start_relative_velocity_h": Quantity(RUN_VECTOR, "m/s", "first guess of its velocity"),
    "start_q_cb": Quantity(("run", "quaternion"), "1", "first guess of the attitude to the camera"),
    "start_rate_b": Quantity(RUN_VECTOR, "rad/s", "first guess of the rate"),
    "start_inertia_b": Quantity(("run", "row", "column"), "kg m2", "first guess of the inertia"),
    "start_point_c": Quantity(POINT, "m", "first guess of the features in camera axes"),
    "relative_position_h": Quantity(TIME_VECTOR, "m", "estimated chaser_position_h"),
    "relative_velocity_h": Quantity(TIME_VECTOR, "m/s", "estimated chaser_velocity_h"),
    "q_hb": Quantity(TIME_QUATERNION, "1", "estimated attitude, body to Hill axes"),
    "q_cb": Quantity(TIME_QUATERNION, "1", "estimated attitude, body to camera axes"),
    "log_inertia": Quantity((*TIME, "log_ratio"), "1", "estimated log-ratios of the inertia"),
    "inertia_b": Quantity((*TIME, "row", "column"), "kg m2", "estimated inertia tensor"),
    "range_bias": Quantity(TIME, "m", "estimated distance of the surface from the centre of mass"),
    "camera_bias": Quantity(TIME_VECTOR, "rad", "estimated error of known_q_hc, camera axes"),
    "point_c": Quantity((*TIME, "feature", "axis"), "m", "estimated features from the camera"),
    "first_point_error": Quantity(TIME_VECTOR, "m", "error of the first feature"),
    "attitude_error": Quantity(TIME_VECTOR, "rad", "error of the attitude, angles in body axes"),
}


def _components(name: str, unit: str, table_unit: str, words: str) -> dict[str, Quantity]:
    return {
        f"{name}_{axis}": Quantity(TIME, unit, f"error of {words}, component {axis}", table_unit)
        for axis in (1, 2, 3)
    }


QUANTITIES = {
    **with_sigmas(_ESTIMATED),
    "points": Quantity(TIME, "m", "error of the features, RMS over them", "m"),
    "inertia": Quantity(TIME, "1", "relative error of the inertia's shape", "1"),
    "inertia_tensor": Quantity(TIME, "kg m2", "2-norm of the inertia's error", "kg m2"),
    "constraint": Quantity(TIME, "m", "disagreement of point_c and point_b, RMS", "m"),
    "gauge": Quantity(TIME, "rad", "angle of the best rotation of the features", "deg"),
    "aligned_rate": Quantity(TIME, "rad/s", "rate error after it", "deg/s"),
    "aligned_attitude": Quantity(TIME, "rad", "attitude error after it", "deg"),
    "aligned_points": Quantity(TIME, "m", "error of the features after it, RMS", "m"),
    "aligned_inertia": Quantity(TIME, "1", "relative error of the inertia's shape after it", "1"),
    "unobservable_ratios": Quantity(
        *(RUN, "1", "directions of log_inertia nothing tells of", "1"),
        after_figure=" of 5 unobservable",
    ),
    "ratio_deviation": Quantity(RUN, "1", "1-sigma of the worst direction that is told", "1"),
    "position_remaining": Quantity(RUN, "1", "position error at the end by that at first", "1"),
    "velocity_remaining": Quantity(RUN, "1", "velocity error at the end by that at first", "1"),
    "rate_remaining": Quantity(RUN, "1", "rate error at the end by that at first", "1"),
    "points_remaining": Quantity(RUN, "1", "error of features at the end by that at first", "1"),
    "inertia_remaining": Quantity(RUN, "1", "inertia_tensor at the end by that at first", "1"),
    "aligned_rate_remaining": Quantity(RUN, "1", "aligned_rate by the first rate error", "1"),
    "aligned_points_remaining": Quantity(RUN, "1", "aligned_points by the first error", "1"),
    "camera_points": Quantity(TIME, "m", "error of point_c, RMS over the features", "m"),
    **_components("position", "m", "m", "relative position, Hill axes"),
    **_components("velocity", "m/s", "m/s", "relative velocity, Hill axes"),
    **_components("rate_b", "rad/s", "deg/s", "rate, body axes"),
    **_components("attitude", "rad", "deg", "attitude, angle about body axis"),
    **_components("first_point", "m", "m", "first feature, body axes"),
    **_components("first_point_c", "m", "m", "first feature from the camera, its axes"),
    **{
        f"tensor_{name}": Quantity(TIME, "kg m2", f"error of I{name}, body axes", "kg m2")
        for name in ("xx", "yy", "zz", "xy", "xz", "yz")
    },
    "guess_position": Quantity(RUN, "m", "position error of the first guess", "m"),
    "guess_velocity": Quantity(RUN, "m/s", "velocity error of the first guess", "m/s"),
    "guess_rate": Quantity(RUN, "rad/s", "rate error of the first guess", "deg/s"),
    "guess_points": Quantity(RUN, "m", "error of the features at first, RMS over them", "m"),
    "guess_inertia_tensor": Quantity(RUN, "kg m2", "inertia_tensor of the first guess", "kg m2"),
    "position_convergence": Quantity(RUN, "s", "position error below a tenth of the first", "s"),
    "velocity_convergence": Quantity(RUN, "s", "velocity error below a tenth of the first", "s"),
    "first_point_c_error": Quantity(TIME_VECTOR, "m", "error of the first feature of point_c"),
    "inertia_error": Quantity((*TIME, "row", "column"), "kg m2", "error of inertia_b"),
    "log_inertia_error": Quantity((*TIME, "log_ratio"), "1", "error of log_inertia"),
    "reference_point_b": Quantity(POINT, "m", "true features in the estimator's body axes"),
}
