"""What only measured data have, and what single images of a known body tell."""

from debrisest.quantity import TIME, TIME_VECTOR, Quantity

QUANTITIES = {
    "notes": Quantity(("notes",), "", "what was understood of the files, in sentences"),
    "point_sigma": Quantity(
        (*TIME, "feature", "axis"), "m", "1-sigma of measured_point; NaN where it is not known"
    ),
    "rig_rotation": Quantity(
        ("run", "camera", "row", "column"), "1", "turns the first camera's vectors into a camera's"
    ),
    "rig_translation": Quantity(
        ("run", "camera", "axis"), "m", "origin of the first camera in a camera's axes"
    ),
    "given_rotation": Quantity(
        (*TIME, "row", "column"), "1", "turns the axes of places that are given into the camera's"
    ),
    "given_translation": Quantity(TIME_VECTOR, "m", "origin of these axes in the camera's"),
    "measured_q_if_covariance": Quantity(
        (*TIME, "row", "column"), "rad2", "covariance of the turn, inertial axes"
    ),
    "measured_rate_f": Quantity(TIME_VECTOR, "rad/s", "measured rate, in axes fixed in the body"),
    "rate_f_noise": Quantity(TIME, "rad/s", "1-sigma of it about each axis; NaN if not known"),
    "measured_position": Quantity(TIME_VECTOR, "m", "origin of the body's axes, from the chaser"),
}
