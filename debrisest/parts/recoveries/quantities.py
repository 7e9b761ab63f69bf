"""What recoveries give, and their errors."""

from debrisest.quantity import RUN, TIME, TIME_QUATERNION, TIME_VECTOR, Quantity

QUANTITIES = {
    "raw_q_if": Quantity(TIME_QUATERNION, "1", "attitude from the points of one epoch"),
    "q_if": Quantity(TIME_QUATERNION, "1", "recovered attitude of the feature frame"),
    "piece": Quantity(TIME, "1", "piece of uninterrupted samples the epoch belongs to"),
    "sign": Quantity(("run", "piece_number"), "1", "sign given to each piece"),
    "hypothesis_sign": Quantity(
        ("run", "hypothesis", "piece_number"), "1", "signs that the search tried for its pieces"
    ),
    "hypothesis_score": Quantity(("run", "hypothesis"), "1", "penalty of these signs"),
    "hypothesis_q0": Quantity(
        ("run", "hypothesis", "time_s"), "1", "first component of q_if, recovered with them"
    ),
    "objective": Quantity(("run", "quaternion"), "1", "objective of each component's recovery"),
    "iterations": Quantity(("run", "quaternion"), "1", "iterations of each component's recovery"),
    "exact_recovery_gap": Quantity(
        RUN, "1", "1 - exact recovery coefficient of the lines of the scalar part", "1"
    ),
    "lines": Quantity(RUN, "1", "lines of the recovered spectrum", "1"),
    "recovered_pitch": Quantity(TIME, "rad", "pitch error of the recovered attitude", "deg"),
    "recovered_attitude": Quantity(TIME, "rad", "angle error of the recovered attitude", "deg"),
    "observed_pitch": Quantity(RUN, "rad", "RMS of recovered_pitch where observed", "deg"),
    "observed_attitude": Quantity(RUN, "rad", "RMS of recovered_attitude where observed", "deg"),
    "gap_pitch": Quantity(RUN, "rad", "RMS of recovered_pitch inside the gaps", "deg"),
    "gap_attitude": Quantity(RUN, "rad", "RMS of recovered_attitude inside the gaps", "deg"),
    "view_rotation": Quantity(
        ("run", "time_s", "row", "column"), "1", "turns the structure's axes into the camera's"
    ),
    "view_translation": Quantity(TIME_VECTOR, "m", "origin of these axes in the camera's"),
    "cloud_point_r": Quantity(("run", "cloud_point", "axis"), "m", "points of the body's surface"),
    "cloud_seen": Quantity(("run", "time_s", "cloud_point"), "1", "which frames see a point"),
    "scale_spread": Quantity(RUN, "1", "relative 1-sigma of the scale; infinite: no scale"),
    "reprojection": Quantity(RUN, "px", "mean distance of features from where they should be"),
    "found_camera_matrix": Quantity(
        ("run", "camera", "row", "column"), "px", "camera matrix, as given or as images tell it"
    ),
    "found_lens_distortion": Quantity(
        ("run", "camera", "coefficient"), "1", "k1, k2, p1, p2, k3, as given or as images tell them"
    ),
    "found_focal_spread": Quantity(RUN, "1", "relative 1-sigma of the focal length; 0: given"),
    "found_distortion_spread": Quantity(
        RUN, "1", "1-sigma of k1; 0: given, or the images do not tell it"
    ),
    "coverage": Quantity(RUN, "1", "share of epochs with an attitude", "1"),
    "pieces": Quantity(RUN, "1", "pieces of uninterrupted samples", "1", two_sided=True),
    "signs_right": Quantity(RUN, "1", "share of sign decisions that were right", "1"),
    "signs_all_right": Quantity(RUN, "1", "every sign of the run right", "1"),
    "solved": Quantity(RUN, "1", "recovery converged in every component", "1"),
}
