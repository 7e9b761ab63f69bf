"""What is estimated of a tumbling body, and the errors."""

from debrisest.quantity import RUN, TIME, TIME_QUATERNION, TIME_VECTOR, Quantity, with_sigmas

_ESTIMATED = {
    "q_ib": Quantity(TIME_QUATERNION, "1", "estimated attitude of principal axes"),
    "q_bf": Quantity(TIME_QUATERNION, "1", "estimated attitude of features in principal axes"),
    "moments_b": Quantity(TIME_VECTOR, "1", "principal moments of inertia, unit norm"),
}

QUANTITIES = {
    **with_sigmas(_ESTIMATED),
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
