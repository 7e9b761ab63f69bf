"""What is estimated of a tumbling body, and the errors."""

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

_ESTIMATED = {
    "rate_f": Quantity(TIME_VECTOR, "rad/s", "estimated rate in the feature frame"),
    "log_inertia_f": Quantity(
        (*TIME, "log_ratio"), "1", "estimated log of the inertia in the feature frame, traceless"
    ),
    "point_f": Quantity(POINT, "m", "features in their own frame, estimated or given"),
    "speed_end": Quantity(RUN, "rad/s", "size of the rate at the last epoch", "deg/s"),
    "mean_speed": Quantity(RUN, "rad/s", "size of the rate, mean over the epochs", "deg/s"),
    "nutation_angle": Quantity(
        RUN, "rad", "angle of the angular momentum to the axis it circles, last epoch", "deg"
    ),
    "nutation_period": Quantity(RUN, "s", "after which the rate in the body is the same", "s"),
    "spin_axis_i": Quantity(RUN_VECTOR, "1", "direction of the rate at the last epoch"),
    "momentum_axis_i": Quantity(RUN_VECTOR, "1", "direction of the angular momentum"),
    "moment_share": Quantity(RUN_VECTOR, "1", "principal moments over the largest, ascending"),
    "q_ib": Quantity(TIME_QUATERNION, "1", "estimated attitude of principal axes"),
    "q_bf": Quantity(TIME_QUATERNION, "1", "estimated attitude of features in principal axes"),
    "moments_b": Quantity(TIME_VECTOR, "1", "principal moments of inertia, unit norm"),
}

QUANTITIES = {
    **with_sigmas(_ESTIMATED),
    "q_if_sigma": Quantity(TIME_QUATERNION, "1", "1-sigma of q_if"),
    "accepted": Quantity(RUN, "1", "torque-free motion was tested and holds", "1"),
    "startable": Quantity(RUN, "1", "six epochs show three points that are not in line", "1"),
    "accepted_and_right": Quantity(RUN, "1", "accepted, and within five of its own sigmas", "1"),
    "accepted_and_wrong": Quantity(RUN, "1", "accepted, and not within five of its sigmas", "1"),
    "missed": Quantity(RUN, "1", "startable, but not accepted and right", "1"),
    "features_used": Quantity(RUN, "1", "features that belong to the body, where it has them", "1"),
    "on_other_body": Quantity(
        ("run", "feature"), "1", "1 for features left out that are one rigid body themselves"
    ),
    "lost_directions": Quantity(
        *(RUN, "1", "numbers of the inertia, of five, that the motion does not show", "1"),
        after_figure=" of 5 unobservable",
    ),
    "rejected_share": Quantity(RUN, "1", "share of the measurements that do not count", "1"),
    "noise_found": Quantity(RUN, "", "noise as taken, over the given one, or in its unit"),
    "holds_from": Quantity(RUN, "s", "from when torque-free motion explains the data"),
    "holds_until": Quantity(RUN, "s", "until when it does"),
    "observations_used": Quantity(TIME, "1", "measurements of the epoch that count", "1"),
    "relabeling": Quantity(("run", "row", "column"), "1", "estimated to true principal axes"),
    "pitch": Quantity(TIME, "rad", "pitch error", "deg"),
    "rate_1": Quantity(TIME, "rad/s", "rate error about principal axis 1", "deg/s"),
    "rate_2": Quantity(TIME, "rad/s", "rate error about principal axis 2", "deg/s"),
    "rate_3": Quantity(TIME, "rad/s", "rate error about principal axis 3", "deg/s"),
    "inertia_1": Quantity(TIME, "1", "error of principal moment 1 (unit norm)", "1"),
    "inertia_2": Quantity(TIME, "1", "error of principal moment 2 (unit norm)", "1"),
    "inertia_3": Quantity(TIME, "1", "error of principal moment 3 (unit norm)", "1"),
    "convergence_time": Quantity(RUN, "s", "rate error below its limit for good", "s"),
}
