"""Every stored quantity: name, axes, unit. The store, the tables and the plots read them here.

Values are SI and radians; an error's table unit is what the tables print. Frames are suffixes:
``i`` inertial axes, ``b`` body axes, ``f`` the frame built on the target's first three features,
``c`` camera. NaN means "not observed" or "not available" everywhere.
"""

from typing import NamedTuple

import numpy as np


class Quantity(NamedTuple):
    """What a dataset holds: its axes, its SI unit, its name in words and its unit in tables."""

    axes: tuple[str, ...]
    unit: str
    long_name: str
    table_unit: str = ""


COORDINATES = ("run", "time_s", "feature", "covariance_time_s", "error_name")
"""Axes that have a coordinate of the same name; every other axis is a plain index."""

AXIS_LENGTH = {"quaternion": 4, "axis": 3, "row": 3, "column": 3, "ratio": 2, "image_axis": 2}

_TIME = ("run", "time_s")
_TIME_VECTOR = (*_TIME, "axis")
_TIME_QUATERNION = (*_TIME, "quaternion")
_TIME_RATIO = (*_TIME, "ratio")
_TIME_IMAGE = (*_TIME, "camera", "feature", "image_axis")
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
    "failure": Quantity(_RUN, "", "why the run gave no result (empty: it did)"),
    "status": Quantity(_RUN, "", "how the stage ended, in words"),
    "recover_status": Quantity(_RUN, "", "status of the recovery, as later stages read it"),
    "filter_status": Quantity(_RUN, "", "status of the filter, as later stages read it"),
    # simulate
    "orbit_position": Quantity(_TIME_VECTOR, "m", "position on the orbit, Earth-centred inertial"),
    "orbit_velocity": Quantity(
        _TIME_VECTOR, "m/s", "velocity on the orbit, Earth-centred inertial"
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
    # recover
    "raw_q_if": Quantity(_TIME_QUATERNION, "1", "attitude from the points of one epoch"),
    "q_if": Quantity(_TIME_QUATERNION, "1", "recovered attitude of the feature frame"),
    "piece": Quantity(_TIME, "1", "piece of uninterrupted samples the epoch belongs to"),
    "sign": Quantity(("run", "piece_number"), "1", "sign given to each piece"),
    "objective": Quantity(("run", "quaternion"), "1", "objective of each component's recovery"),
    "iterations": Quantity(("run", "quaternion"), "1", "iterations of each component's recovery"),
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
    "covariance": Quantity(
        ("run", "covariance_time_s", "error_name", "error_column"), "", "covariance of the state"
    ),
    "nis": Quantity(_TIME, "1", "normalised innovation squared; assess: per dimension", "1"),
    "nis_dof": Quantity(_TIME, "1", "measured components at the epoch"),
    "rejected": Quantity(_TIME, "1", "components that the gate rejected at the epoch"),
    "reopened": Quantity(_RUN, "1", "times that the gate was reopened", "1"),
    "updates": Quantity(_TIME, "1", "iterations of the update at the epoch"),
    "converged": Quantity(_RUN, "1", "the last replay converged", "1"),
    "repairs": Quantity(_RUN, "1", "covariance repairs", "1"),
    # assess
    "relabeling": Quantity(("run", "row", "column"), "1", "estimated to true principal axes"),
    "recovered_pitch": Quantity(_TIME, "rad", "pitch error of the recovered attitude", "deg"),
    "recovered_attitude": Quantity(_TIME, "rad", "angle error of the recovered attitude", "deg"),
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
    "k1": Quantity(_TIME, "1", "error of ln(Ix/Iy), absolute", "1"),
    "k2": Quantity(_TIME, "1", "error of ln(Iy/Iz), absolute", "1"),
    "nees": Quantity(_TIME, "1", "normalised error squared per dimension", "1"),
    "nees_dof": Quantity(_TIME, "1", "errors that it counts, where the covariance was kept"),
    "convergence_time": Quantity(_RUN, "s", "rate error below its limit for good", "s"),
}

_TABLE_SCALE = {("rad", "deg"): 180 / np.pi, ("rad/s", "deg/s"): 180 / np.pi, ("m", "km"): 1e-3}


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


def table_scale(name: str) -> float:
    """Return the factor from a quantity's SI unit to the unit that the tables print."""
    quantity = VOCABULARY[name]
    return _TABLE_SCALE.get((quantity.unit, quantity.table_unit), 1.0)
