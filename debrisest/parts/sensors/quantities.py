"""What sensors measure, and what estimators know of them."""

from debrisest.quantity import RUN, TIME, TIME_QUATERNION, TIME_VECTOR, Quantity

_TIME_IMAGE = (*TIME, "camera", "detection", "image_axis")
_TIME_OBSERVER = (*TIME, "observer")
_CONTROL = ("run", "control_time_s", "observer")

QUANTITIES = {
    "measured_image": Quantity(
        (*TIME, "camera", "image_row", "image_column"), "1", "grey levels from 0 to 255"
    ),
    "measured_chroma": Quantity(
        (*TIME, "camera", "image_row", "image_column", "chroma"),
        "1",
        "Cr and Cb of images that have colours, from 0 to 255",
    ),
    "measured_mask": Quantity(
        (*TIME, "camera", "image_row", "image_column"), "1", "masks of the body: 255 where it is"
    ),
    "camera_matrix": Quantity(("run", "camera", "row", "column"), "px", "camera matrix"),
    "lens_distortion": Quantity(("run", "camera", "coefficient"), "1", "k1, k2, p1, p2, k3"),
    "focal_spread": Quantity(RUN, "1", "relative 1-sigma of the focal length; 0: calibrated"),
    "focal_source": Quantity(RUN, "", "where the focal length comes from, in words"),
    "baseline": Quantity(RUN, "m", "distance between the cameras"),
    "camera_q_lc": Quantity(("run", "quaternion"), "1", "attitude of the cameras to the leader"),
    "measured_q_if": Quantity(TIME_QUATERNION, "1", "measured attitude of features or body axes"),
    "q_if_noise": Quantity(TIME, "rad", "1-sigma of its error about each axis; NaN if not known"),
    "focal_px": Quantity(RUN, "px", "focal length"),
    "measured_pixel": Quantity(
        _TIME_IMAGE, "px", "pixels of the features in their order, or of points without labels"
    ),
    "pixel_noise": Quantity(RUN, "px", "1-sigma noise of pixels, rounding included"),
    "measured_flow": Quantity(_TIME_IMAGE, "px/s", "time derivative of pixels"),
    "flow_noise": Quantity(RUN, "px/s", "1-sigma noise of the flow"),
    "measured_disparity": Quantity((*TIME, "feature"), "px", "difference between both cameras"),
    "disparity_noise": Quantity(RUN, "px", "1-sigma noise of the disparity"),
    "measured_angular_acceleration": Quantity(TIME_VECTOR, "rad/s2", "in principal axes"),
    "angular_acceleration_noise": Quantity(RUN, "rad/s2", "1-sigma noise per axis"),
    "measured_point": Quantity((*TIME, "feature", "axis"), "m", "feature relative to the chaser"),
    "point_noise": Quantity(RUN, "m", "1-sigma noise of each coordinate of a feature"),
    "image_half_size": Quantity(("run", "image_axis"), "px", "half the width and the height"),
    "true_q_ic": Quantity((*_TIME_OBSERVER, "quaternion"), "1", "attitude of the cameras"),
    "known_q_ic": Quantity(
        (*_TIME_OBSERVER, "quaternion"), "1", "attitude of the cameras as the estimators know it"
    ),
    "true_euler": Quantity(
        (*_TIME_OBSERVER, "axis"), "rad", "Euler angles 3-2-1 from the local orbital axes"
    ),
    "section": Quantity(TIME, "1", "even: estimation, odd: the cameras are turned"),
    "true_pixel": Quantity(
        (*_TIME_OBSERVER, "image_axis"), "px", "pixel of the debris, not rounded"
    ),
    "target_detection": Quantity(
        _TIME_OBSERVER, "1", "which detection is the debris' own; -1 if none"
    ),
    "control_time_s": Quantity(("control_time_s",), "s", "times of the stored control steps"),
    "torque": Quantity((*_CONTROL, "axis"), "N m", "control torque, body axes"),
    "control_pixel": Quantity((*_CONTROL, "image_axis"), "px", "pixel of the debris, not rounded"),
    "cameras_at_start": Quantity(RUN, "1", "cameras that see the debris at time zero", "1"),
    "pointing_status": Quantity(RUN, "", "whether the debris was in view at each epoch"),
    "first_section": Quantity(
        RUN, "s", "when cameras are turned for the first time", "s", two_sided=True
    ),
    "settling_time": Quantity(RUN, "s", "until the pixel stays within 5 px, if it does", "s"),
    "stage_one_time": Quantity(RUN, "s", "length of the first stage of control", "s"),
    "peak_torque": Quantity(RUN, "N m", "largest component of the torque", "mN m"),
    "total_variation": Quantity(RUN, "N m", "sum of the steps of a torque component", "mN m"),
    "drift_mismatch": Quantity(
        RUN, "1", "error of the modelled state function over that function (F)", "1"
    ),
    "gain_mismatch": Quantity(
        RUN, "1", "largest entry of B B_model^-1 - I, B the matrix of the torques (D)", "1"
    ),
    "final_angle": Quantity(RUN, "rad", "largest Euler angle after turning", "deg"),
    "true_q_hc": Quantity(TIME_QUATERNION, "1", "attitude of the camera, camera to Hill axes"),
    "known_q_hc": Quantity(TIME_QUATERNION, "1", "the same as the estimators know it"),
    "measured_range": Quantity(TIME, "m", "range along the camera's optical axis"),
    "landmark": Quantity(TIME, "1", "which feature landmark_range belongs to, from 0"),
    "landmark_range": Quantity(TIME, "m", "range to a feature in front"),
    "range_noise": Quantity(RUN, "m", "1-sigma noise of ranges"),
    "attitude_noise": Quantity(RUN, "rad", "1-sigma noise of known_q_hc per camera axis"),
}
