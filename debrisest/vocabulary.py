"""Every stored quantity: name, axes, unit. The store, the tables and the plots read them here.

Values are SI and radians; an error's table unit is what the tables print. Frames are suffixes:
``i`` inertial axes, ``b`` body axes, ``f`` the frame built on the target's first three features,
``c`` camera. NaN means "not observed" or "not available" everywhere.
"""

from typing import NamedTuple

import numpy as np


class ChiSquare(NamedTuple):
    """Where a quantity is, if the estimator is consistent, a chi-square over its freedom."""

    freedom: str
    """The dataset that holds its degrees of freedom."""
    white: bool
    """Whether its values at different epochs are independent."""


class Quantity(NamedTuple):
    """What a dataset holds: its axes, its SI unit, its name in words and its unit in tables."""

    axes: tuple[str, ...]
    unit: str
    long_name: str
    table_unit: str = ""
    chi_square: ChiSquare | None = None
    """Of a normalised square per dimension, which the tables judge in words."""


COORDINATES = (
    *("run", "time_s", "feature", "observer", "control_time_s"),
    *("covariance_time_s", "error_name"),
)
"""Axes that have a coordinate of the same name; every other axis is a plain index."""

AXIS_LENGTH = {
    "quaternion": 4,
    "axis": 3,
    "row": 3,
    "column": 3,
    "ratio": 2,
    "image_axis": 2,
    "log_ratio": 5,
}

_TIME = ("run", "time_s")
_TIME_VECTOR = (*_TIME, "axis")
_TIME_QUATERNION = (*_TIME, "quaternion")
_TIME_RATIO = (*_TIME, "ratio")
_TIME_IMAGE = (*_TIME, "camera", "feature", "image_axis")
_TIME_OBSERVER = (*_TIME, "observer")
_CONTROL = ("run", "control_time_s", "observer")
_COMPANION = ("run", "companion", "axis")
_POINT = ("run", "feature", "axis")
_RUN_VECTOR = ("run", "axis")
_RUN = ("run",)

VOCABULARY: dict[str, Quantity] = {
    # coordinates
    "run": Quantity(_RUN, "1", "Monte Carlo run"),
    "time_s": Quantity(("time_s",), "s", "time since the start of the scenario"),
    "feature": Quantity(("feature",), "", "name of the feature of the target"),
    "covariance_time_s": Quantity(("covariance_time_s",), "s", "times of the stored covariances"),
    "error_name": Quantity(("error_name",), "", "components of the filter's error state"),
    "observer": Quantity(("observer",), "", "name of the observing satellite"),
    "control_time_s": Quantity(("control_time_s",), "s", "times of the stored control steps"),
    "failure": Quantity(_RUN, "", "why the run gave no result (empty: it did)"),
    "status": Quantity(_RUN, "", "how the stage ended, in words"),
    "recover_status": Quantity(_RUN, "", "status of the recovery, as later stages read it"),
    "filter_status": Quantity(_RUN, "", "status of the filter, as later stages read it"),
    # simulate
    "orbit_position": Quantity(_TIME_VECTOR, "m", "position on the orbit, Earth-centred inertial"),
    "orbit_velocity": Quantity(
        _TIME_VECTOR, "m/s", "velocity on the orbit, Earth-centred inertial"
    ),
    "observer_position": Quantity(
        (*_TIME_OBSERVER, "axis"), "m", "position of the observers, Earth-centred inertial"
    ),
    "observer_velocity": Quantity(
        (*_TIME_OBSERVER, "axis"), "m/s", "velocity of the observers, Earth-centred inertial"
    ),
    "true_q_ib": Quantity(_TIME_QUATERNION, "1", "attitude of the body, body to inertial axes"),
    "true_rate_b": Quantity(_TIME_VECTOR, "rad/s", "angular rate of the body in body axes"),
    "true_inertia_b": Quantity(("run", "row", "column"), "kg m2", "inertia tensor in body axes"),
    "true_point_b": Quantity(("run", "feature", "axis"), "m", "features in body axes"),
    "true_normal_b": Quantity(("run", "feature", "axis"), "1", "outward normals at the features"),
    "known_point_f": Quantity(
        ("run", "feature", "axis"), "m", "features as the estimators know them, in their own frame"
    ),
    "true_position": Quantity(_TIME_VECTOR, "m", "target relative to the chaser"),
    "true_velocity": Quantity(_TIME_VECTOR, "m/s", "target's velocity relative to the chaser"),
    "true_q_lt": Quantity(_TIME_QUATERNION, "1", "attitude, target to leader's orbital frame"),
    "true_rate_l": Quantity(_TIME_VECTOR, "rad/s", "rate relative to leader's frame, in its axes"),
    "true_inertia_ratio": Quantity(("run", "ratio"), "1", "ln(Ix/Iy) and ln(Iy/Iz)"),
    "baseline": Quantity(_RUN, "m", "distance between the cameras"),
    "measured_pixel": Quantity(_TIME_IMAGE, "1", "slopes of features, focal length 1"),
    "pixel_noise": Quantity(_RUN, "1", "1-sigma noise of slopes"),
    "measured_flow": Quantity(_TIME_IMAGE, "1/s", "time derivative of slopes"),
    "flow_noise": Quantity(_RUN, "1/s", "1-sigma noise of the flow"),
    "measured_disparity": Quantity((*_TIME, "feature"), "1", "difference between both cameras"),
    "disparity_noise": Quantity(_RUN, "1", "1-sigma noise of the disparity"),
    "measured_angular_acceleration": Quantity(_TIME_VECTOR, "rad/s2", "in principal axes"),
    "angular_acceleration_noise": Quantity(_RUN, "rad/s2", "1-sigma noise per axis"),
    "start_position": Quantity(_RUN_VECTOR, "m", "first guess of the position"),
    "start_position_sigma": Quantity(_RUN_VECTOR, "m", "its 1-sigma"),
    "start_velocity": Quantity(_RUN_VECTOR, "m/s", "first guess of the velocity"),
    "start_velocity_sigma": Quantity(_RUN_VECTOR, "m/s", "its 1-sigma"),
    "start_rate_l": Quantity(_RUN_VECTOR, "rad/s", "first guess of the rate"),
    "start_rate_l_sigma": Quantity(_RUN_VECTOR, "rad/s", "its 1-sigma"),
    "start_q_lt": Quantity(("run", "quaternion"), "1", "first guess of the attitude"),
    "start_q_lt_sigma": Quantity(("run", "quaternion"), "1", "1-sigma before it was normalised"),
    "start_inertia_ratio": Quantity(("run", "ratio"), "1", "first guess of the inertia ratios"),
    "start_inertia_ratio_sigma": Quantity(("run", "ratio"), "1", "its 1-sigma"),
    "start_point_b": Quantity(_POINT, "m", "first guess of the features in body axes"),
    "start_point_b_sigma": Quantity(_POINT, "m", "its 1-sigma"),
    "measured_point": Quantity((*_TIME, "feature", "axis"), "m", "feature relative to the chaser"),
    "point_noise": Quantity(_RUN, "m", "1-sigma noise of each coordinate of a feature"),
    "camera_scale": Quantity(_RUN, "px", "focal length in pixels"),
    "image_half_size": Quantity(("run", "image_axis"), "px", "half the width and the height"),
    "true_q_ic": Quantity((*_TIME_OBSERVER, "quaternion"), "1", "attitude of the cameras"),
    "known_q_ic": Quantity(
        (*_TIME_OBSERVER, "quaternion"), "1", "attitude of the cameras as the estimators know it"
    ),
    "true_euler": Quantity(
        (*_TIME_OBSERVER, "axis"), "rad", "Euler angles 3-2-1 from the local orbital axes"
    ),
    "section": Quantity(_TIME, "1", "even: estimation, odd: the cameras are turned"),
    "true_pixel": Quantity(
        (*_TIME_OBSERVER, "image_axis"), "px", "pixel of the debris, not rounded"
    ),
    "detected_pixel": Quantity(
        (*_TIME_OBSERVER, "detection", "image_axis"), "px", "points that a camera shows, unlabelled"
    ),
    "target_detection": Quantity(
        _TIME_OBSERVER, "1", "which detection is the debris' own; -1 if none"
    ),
    "torque": Quantity((*_CONTROL, "axis"), "N m", "control torque, body axes"),
    "control_pixel": Quantity((*_CONTROL, "image_axis"), "px", "pixel of the debris, not rounded"),
    "start_attitude_bias": Quantity(
        ("run", "observer", "axis"), "rad", "first guess of the error of the known attitude"
    ),
    "start_attitude_bias_sigma": Quantity(("run", "observer", "axis"), "rad", "its 1-sigma"),
    "cameras_at_start": Quantity(_RUN, "1", "cameras that see the debris at time zero", "1"),
    "pointing_status": Quantity(_RUN, "", "whether the debris was in view at each epoch"),
    "first_section": Quantity(_RUN, "s", "when cameras are turned for the first time", "s"),
    "settling_time": Quantity(_RUN, "s", "until the pixel stays within 5 px, if it does", "s"),
    "stage_one_time": Quantity(_RUN, "s", "length of the first stage of control", "s"),
    "peak_torque": Quantity(_RUN, "N m", "largest component of the torque", "mN m"),
    "total_variation": Quantity(_RUN, "N m", "sum of the steps of a torque component", "mN m"),
    "final_angle": Quantity(_RUN, "rad", "largest Euler angle after turning", "deg"),
    "start_orbit_position": Quantity(_RUN_VECTOR, "m", "first guess of the debris' position"),
    "start_orbit_position_sigma": Quantity(_RUN_VECTOR, "m", "its 1-sigma"),
    "start_orbit_velocity": Quantity(_RUN_VECTOR, "m/s", "first guess of the debris' velocity"),
    "start_orbit_velocity_sigma": Quantity(_RUN_VECTOR, "m/s", "its 1-sigma"),
    "start_companion_position": Quantity(_COMPANION, "m", "first guess of the pieces beside it"),
    "start_companion_position_sigma": Quantity(_COMPANION, "m", "its 1-sigma"),
    "start_companion_velocity": Quantity(_COMPANION, "m/s", "first guess of their velocity"),
    "start_companion_velocity_sigma": Quantity(_COMPANION, "m/s", "its 1-sigma"),
    "chaser_position_h": Quantity(_TIME_VECTOR, "m", "chaser relative to target, Hill axes"),
    "chaser_velocity_h": Quantity(_TIME_VECTOR, "m/s", "its velocity as seen in the Hill frame"),
    "true_q_hc": Quantity(_TIME_QUATERNION, "1", "attitude of the camera, camera to Hill axes"),
    "known_q_hc": Quantity(_TIME_QUATERNION, "1", "the same as the estimators know it"),
    "image_point": Quantity(
        (*_TIME, "feature", "image_axis"), "px", "pixels of the tracked points, from the middle"
    ),
    "measured_range": Quantity(_TIME, "m", "range along the camera's optical axis"),
    "landmark": Quantity(_TIME, "1", "which feature landmark_range belongs to, from 0"),
    "landmark_range": Quantity(_TIME, "m", "range to a feature in front"),
    "focal_px": Quantity(_RUN, "px", "focal length"),
    "image_noise_px": Quantity(_RUN, "px", "1-sigma noise of pixels, rounding included"),
    "range_noise": Quantity(_RUN, "m", "1-sigma noise of ranges"),
    "attitude_noise": Quantity(_RUN, "rad", "1-sigma noise of known_q_hc per camera axis"),
    "start_relative_position_h": Quantity(_RUN_VECTOR, "m", "first guess of the chaser's position"),
    "start_relative_position_h_sigma": Quantity(_RUN_VECTOR, "m", "its 1-sigma"),
    "start_relative_velocity_h": Quantity(_RUN_VECTOR, "m/s", "first guess of its velocity"),
    "start_relative_velocity_h_sigma": Quantity(_RUN_VECTOR, "m/s", "its 1-sigma"),
    "start_q_cb": Quantity(("run", "quaternion"), "1", "first guess of the attitude to the camera"),
    "start_q_cb_sigma": Quantity(("run", "quaternion"), "1", "its 1-sigma"),
    "start_rate_b": Quantity(_RUN_VECTOR, "rad/s", "first guess of the rate"),
    "start_rate_b_sigma": Quantity(_RUN_VECTOR, "rad/s", "its 1-sigma"),
    "start_inertia_b": Quantity(("run", "row", "column"), "kg m2", "first guess of the inertia"),
    "start_inertia_b_sigma": Quantity(("run", "row", "column"), "kg m2", "its 1-sigma"),
    "start_point_c": Quantity(_POINT, "m", "first guess of the features in camera axes"),
    "start_point_c_sigma": Quantity(_POINT, "m", "its 1-sigma"),
    # recover
    "raw_q_if": Quantity(_TIME_QUATERNION, "1", "attitude from the points of one epoch"),
    "q_if": Quantity(_TIME_QUATERNION, "1", "recovered attitude of the feature frame"),
    "piece": Quantity(_TIME, "1", "piece of uninterrupted samples the epoch belongs to"),
    "sign": Quantity(("run", "piece_number"), "1", "sign given to each piece"),
    "objective": Quantity(("run", "quaternion"), "1", "objective of each component's recovery"),
    "iterations": Quantity(("run", "quaternion"), "1", "iterations of each component's recovery"),
    "lines": Quantity(_RUN, "1", "lines of the recovered spectrum", "1"),
    # filter
    "q_ib": Quantity(_TIME_QUATERNION, "1", "estimated attitude of principal axes"),
    "q_ib_sigma": Quantity(_TIME_QUATERNION, "1", "1-sigma of q_ib"),
    "q_bf": Quantity(_TIME_QUATERNION, "1", "estimated attitude of features in principal axes"),
    "q_bf_sigma": Quantity(_TIME_QUATERNION, "1", "1-sigma of q_bf"),
    "rate_b": Quantity(_TIME_VECTOR, "rad/s", "estimated angular rate in principal axes"),
    "rate_b_sigma": Quantity(_TIME_VECTOR, "rad/s", "1-sigma of rate_b"),
    "moments_b": Quantity(_TIME_VECTOR, "1", "principal moments of inertia, unit norm"),
    "moments_b_sigma": Quantity(_TIME_VECTOR, "1", "1-sigma of moments_b"),
    "position": Quantity(
        _TIME_VECTOR, "m", "target relative to the chaser; assess: norm of the error", "m"
    ),
    "position_sigma": Quantity(_TIME_VECTOR, "m", "1-sigma of position"),
    "velocity": Quantity(
        _TIME_VECTOR, "m/s", "target's relative velocity; assess: norm of the error", "m/s"
    ),
    "velocity_sigma": Quantity(_TIME_VECTOR, "m/s", "1-sigma of velocity"),
    "q_lt": Quantity(_TIME_QUATERNION, "1", "estimated attitude, target to leader's frame"),
    "q_lt_sigma": Quantity(_TIME_QUATERNION, "1", "1-sigma of q_lt"),
    "rate_l": Quantity(_TIME_VECTOR, "rad/s", "estimated rate relative to the leader's frame"),
    "rate_l_sigma": Quantity(_TIME_VECTOR, "rad/s", "1-sigma of rate_l"),
    "inertia_ratio": Quantity(_TIME_RATIO, "1", "estimated ln(Ix/Iy) and ln(Iy/Iz)"),
    "inertia_ratio_sigma": Quantity(_TIME_RATIO, "1", "1-sigma of inertia_ratio"),
    "point_b": Quantity((*_TIME, "feature", "axis"), "m", "estimated features in body axes"),
    "point_b_sigma": Quantity((*_TIME, "feature", "axis"), "m", "1-sigma of point_b"),
    "relative_position_h": Quantity(_TIME_VECTOR, "m", "estimated chaser_position_h"),
    "relative_position_h_sigma": Quantity(_TIME_VECTOR, "m", "1-sigma of relative_position_h"),
    "relative_velocity_h": Quantity(_TIME_VECTOR, "m/s", "estimated chaser_velocity_h"),
    "relative_velocity_h_sigma": Quantity(_TIME_VECTOR, "m/s", "1-sigma of relative_velocity_h"),
    "q_hb": Quantity(_TIME_QUATERNION, "1", "estimated attitude, body to Hill axes"),
    "q_hb_sigma": Quantity(_TIME_QUATERNION, "1", "1-sigma of q_hb"),
    "q_cb": Quantity(_TIME_QUATERNION, "1", "estimated attitude, body to camera axes"),
    "q_cb_sigma": Quantity(_TIME_QUATERNION, "1", "1-sigma of q_cb"),
    "log_inertia": Quantity((*_TIME, "log_ratio"), "1", "estimated log-ratios of the inertia"),
    "log_inertia_sigma": Quantity((*_TIME, "log_ratio"), "1", "1-sigma of log_inertia"),
    "inertia_b": Quantity((*_TIME, "row", "column"), "kg m2", "estimated inertia tensor"),
    "inertia_b_sigma": Quantity((*_TIME, "row", "column"), "kg m2", "1-sigma of inertia_b"),
    "range_bias": Quantity(_TIME, "m", "estimated distance of the surface from the centre of mass"),
    "range_bias_sigma": Quantity(_TIME, "m", "1-sigma of range_bias"),
    "camera_bias": Quantity(_TIME_VECTOR, "rad", "estimated error of known_q_hc, camera axes"),
    "camera_bias_sigma": Quantity(_TIME_VECTOR, "rad", "1-sigma of camera_bias"),
    "point_c": Quantity((*_TIME, "feature", "axis"), "m", "estimated features from the camera"),
    "point_c_sigma": Quantity((*_TIME, "feature", "axis"), "m", "1-sigma of point_c"),
    "debris_position": Quantity(_TIME_VECTOR, "m", "estimated position, Earth-centred inertial"),
    "debris_position_sigma": Quantity(_TIME_VECTOR, "m", "1-sigma of debris_position"),
    "debris_velocity": Quantity(_TIME_VECTOR, "m/s", "estimated velocity, Earth-centred inertial"),
    "debris_velocity_sigma": Quantity(_TIME_VECTOR, "m/s", "1-sigma of debris_velocity"),
    "attitude_bias": Quantity(
        (*_TIME_OBSERVER, "axis"), "rad", "estimated error of the known attitude, camera axes"
    ),
    "attitude_bias_sigma": Quantity((*_TIME_OBSERVER, "axis"), "rad", "1-sigma of attitude_bias"),
    "covariance": Quantity(
        ("run", "covariance_time_s", "error_name", "error_column"), "", "covariance of the state"
    ),
    "nis": Quantity(
        *(_TIME, "1", "normalised innovation squared; assess: per dimension", "1"),
        ChiSquare("nis_dof", white=True),
    ),
    "nis_dof": Quantity(_TIME, "1", "measured components at the epoch"),
    "cost": Quantity(_TIME, "1", "twice the negative log posterior density of the estimate"),
    "cost_of_truth": Quantity(_TIME, "1", "the same of the truth, given the same measurements"),
    "rejected": Quantity(
        _TIME, "1", "components that the gate rejected at the epoch; assess: their share", "1"
    ),
    "validated": Quantity(_TIME, "1", "unlabelled detections within the gates at the epoch"),
    "reopened": Quantity(_RUN, "1", "times that the gate was reopened", "1"),
    "updates": Quantity(_TIME, "1", "iterations of the update at the epoch"),
    "converged": Quantity(_RUN, "1", "the last replay converged", "1"),
    "restarts": Quantity(_RUN, "1", "restarts of the batch", "1"),
    "dropped": Quantity(_RUN, "1", "landmarks that were given up", "1"),
    "fit": Quantity(_RUN, "1", "cost of the batch per degree of freedom", "1"),
    "repairs": Quantity(_RUN, "1", "covariance repairs", "1"),
    # assess
    "relabeling": Quantity(("run", "row", "column"), "1", "estimated to true principal axes"),
    "recovered_pitch": Quantity(_TIME, "rad", "pitch error of the recovered attitude", "deg"),
    "recovered_attitude": Quantity(_TIME, "rad", "angle error of the recovered attitude", "deg"),
    "observed_pitch": Quantity(_RUN, "rad", "RMS of recovered_pitch where observed", "deg"),
    "observed_attitude": Quantity(_RUN, "rad", "RMS of recovered_attitude where observed", "deg"),
    "gap_pitch": Quantity(_RUN, "rad", "RMS of recovered_pitch inside the gaps", "deg"),
    "gap_attitude": Quantity(_RUN, "rad", "RMS of recovered_attitude inside the gaps", "deg"),
    "coverage": Quantity(_RUN, "1", "share of epochs with an attitude", "1"),
    "pieces": Quantity(_RUN, "1", "pieces of uninterrupted samples", "1"),
    "signs_right": Quantity(_RUN, "1", "share of sign decisions that were right", "1"),
    "signs_all_right": Quantity(_RUN, "1", "every sign of the run right", "1"),
    "solved": Quantity(_RUN, "1", "recovery converged in every component", "1"),
    "pitch": Quantity(_TIME, "rad", "pitch error", "deg"),
    "attitude": Quantity(_TIME, "rad", "angle of the attitude error", "deg"),
    "rate": Quantity(_TIME, "rad/s", "norm of the rate error", "deg/s"),
    "rate_1": Quantity(_TIME, "rad/s", "rate error about principal axis 1", "deg/s"),
    "rate_2": Quantity(_TIME, "rad/s", "rate error about principal axis 2", "deg/s"),
    "rate_3": Quantity(_TIME, "rad/s", "rate error about principal axis 3", "deg/s"),
    "inertia_1": Quantity(_TIME, "1", "error of principal moment 1 (unit norm)", "1"),
    "inertia_2": Quantity(_TIME, "1", "error of principal moment 2 (unit norm)", "1"),
    "inertia_3": Quantity(_TIME, "1", "error of principal moment 3 (unit norm)", "1"),
    "position_error": Quantity(_TIME_VECTOR, "m", "error of the position"),
    "velocity_error": Quantity(_TIME_VECTOR, "m/s", "error of the velocity"),
    "rate_error": Quantity(_TIME_VECTOR, "rad/s", "error of the rate"),
    "inertia_ratio_error": Quantity(_TIME_RATIO, "1", "error of the inertia ratios"),
    "debris_position_error": Quantity(_TIME_VECTOR, "m", "error of debris_position"),
    "pixel": Quantity(_TIME, "px", "how far the debris is from where it is expected", "px"),
    "lost": Quantity(_TIME, "1", "1 where pixel is above 10 px, else 0", "1"),
    "far": Quantity(_TIME, "1", "1 where the position error is above 5 km, else 0", "1"),
    "position_spread": Quantity(_TIME, "m", "root of the trace of the position's covariance", "km"),
    "covariance_trace": Quantity(
        _TIME, "m2", "trace of the covariance of position, m^2, and velocity, m^2/s^2", "km2"
    ),
    "bias_error": Quantity(_TIME, "rad", "root mean square error of attitude_bias", "mrad"),
    "k1": Quantity(_TIME, "1", "error of ln(Ix/Iy), absolute", "1"),
    "k2": Quantity(_TIME, "1", "error of ln(Iy/Iz), absolute", "1"),
    "points": Quantity(_TIME, "m", "error of the features, RMS over them", "m"),
    "inertia": Quantity(_TIME, "1", "relative error of the inertia's shape", "1"),
    "inertia_tensor": Quantity(_TIME, "kg m2", "2-norm of the inertia's error", "kg m2"),
    "constraint": Quantity(_TIME, "m", "disagreement of point_c and point_b, RMS", "m"),
    "gauge": Quantity(_TIME, "rad", "angle of the best rotation of the features", "deg"),
    "aligned_rate": Quantity(_TIME, "rad/s", "rate error after it", "deg/s"),
    "aligned_attitude": Quantity(_TIME, "rad", "attitude error after it", "deg"),
    "aligned_points": Quantity(_TIME, "m", "error of the features after it, RMS", "m"),
    "aligned_inertia": Quantity(_TIME, "1", "relative error of the inertia's shape after it", "1"),
    "unobservable_ratios": Quantity(_RUN, "1", "directions of log_inertia nothing tells of", "1"),
    "ratio_deviation": Quantity(_RUN, "1", "1-sigma of the worst direction that is told", "1"),
    "position_remaining": Quantity(_RUN, "1", "position error at the end by that at first", "1"),
    "velocity_remaining": Quantity(_RUN, "1", "velocity error at the end by that at first", "1"),
    "rate_remaining": Quantity(_RUN, "1", "rate error at the end by that at first", "1"),
    "points_remaining": Quantity(_RUN, "1", "error of features at the end by that at first", "1"),
    "inertia_remaining": Quantity(_RUN, "1", "inertia_tensor at the end by that at first", "1"),
    "aligned_rate_remaining": Quantity(_RUN, "1", "aligned_rate by the first rate error", "1"),
    "aligned_points_remaining": Quantity(_RUN, "1", "aligned_points by the first error", "1"),
    "first_point_error": Quantity(_TIME_VECTOR, "m", "error of the first feature"),
    "first_point_error_sigma": Quantity(_TIME_VECTOR, "m", "1-sigma of first_point_error"),
    "attitude_error": Quantity(_TIME_VECTOR, "rad", "error of the attitude, angles in body axes"),
    "attitude_error_sigma": Quantity(_TIME_VECTOR, "rad", "1-sigma of attitude_error"),
    "inertia_error": Quantity((*_TIME, "row", "column"), "kg m2", "error of inertia_b"),
    "log_inertia_error": Quantity((*_TIME, "log_ratio"), "1", "error of log_inertia"),
    "reference_point_b": Quantity(_POINT, "m", "true features in the estimator's body axes"),
    "nees": Quantity(
        *(_TIME, "1", "normalised error squared per dimension", "1"),
        ChiSquare("nees_dof", white=False),
    ),
    "nees_dof": Quantity(_TIME, "1", "errors that it counts, where the covariance was kept"),
    "w": Quantity(
        *(_TIME, "1", "excess of the truth's cost over the estimate's per dimension", "1"),
        ChiSquare("w_dof", white=False),
    ),
    "w_dof": Quantity(_TIME, "1", "errors that it counts, where costs were kept"),
    "convergence_time": Quantity(_RUN, "s", "rate error below its limit for good", "s"),
}

_TABLE_SCALE = {
    ("rad", "deg"): 180 / np.pi,
    ("rad", "mrad"): 1e3,
    ("rad/s", "deg/s"): 180 / np.pi,
    ("m", "km"): 1e-3,
    ("m2", "km2"): 1e-6,
    ("N m", "mN m"): 1e3,
}


TWO_SIDED = ("first_section",)
"""Quantities of the tables that are no errors: more is as bad as less."""

WHERE_KEPT = ("nees", "w")
"""Quantities of the tables that are known only where a filter kept its covariance."""


def has_runs(name: str) -> bool:
    """Return whether a dataset's first axis is the run."""
    return VOCABULARY[name].axes[0] == "run"


def axes_of(name: str, dimensions: int) -> tuple[str, ...]:
    """Return the axes of a dataset; an error named like an estimated vector is its norm."""
    quantity = VOCABULARY[name]
    is_norm = quantity.table_unit and dimensions == len(quantity.axes) - 1
    axes = quantity.axes[:-1] if is_norm else quantity.axes
    if len(axes) != dimensions:
        raise ValueError(f"{name} has {dimensions} axes, the vocabulary says {quantity.axes}")
    return axes


def table_scale(name: str, unit: str = "") -> float:
    """Return the factor from a quantity's SI unit to a unit, by default that of the tables."""
    quantity = VOCABULARY[name]
    return _TABLE_SCALE.get((quantity.unit, unit or quantity.table_unit), 1.0)


def possible_units(name: str) -> list[str]:
    """Return the units in which a table can show a quantity, its own first."""
    quantity = VOCABULARY[name]
    others = [unit for si, unit in _TABLE_SCALE if si == quantity.unit]
    return list(dict.fromkeys([quantity.table_unit, quantity.unit, *others]))
