"""The stereo pose problem's datasets as the arrays of its model."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.dynamics import kepler
from debrisest.problems.stereo_pose.model import (
    POINTS,
    POSITION,
    RATE,
    VELOCITY,
    K,
    Q,
    Shown,
    StereoGeometry,
    stereo_geometry,
)
from debrisest.sensors import stereo

Measure = Literal["pixels", "flow", "disparity", "acceleration"]

NAMES = {
    "position": POSITION,
    "velocity": VELOCITY,
    "rate_l": RATE,
    "q_lt": Q,
    "inertia_ratio": K,
    "point_b": POINTS,
}
"""Where each estimated quantity lies in the state."""

DATASETS = {
    "pixels": "pixel",
    "flow": "flow",
    "disparity": "disparity",
    "acceleration": "angular_acceleration",
}


def shown_of(data: Data, measures: list[Measure] | None) -> Shown:
    """Return the groups to use: those that are asked for, or all that are measured."""
    measured = [name for name, dataset in DATASETS.items() if f"measured_{dataset}" in data]
    missing = [name for name in measures or [] if name not in measured]
    if missing:
        raise ValueError(
            f"{', '.join(missing)} cannot be used: no sensor measures it; "
            f"measured: {', '.join(measured)}"
        )
    return Shown(**{name: name in (measures or measured) for name in DATASETS})


def geometry_of(
    data: Data, clock: Clock, measures: list[Measure] | None, raw: bool = False
) -> StereoGeometry:
    """Return what is known without error: the leader's orbit, the cameras, the time steps."""
    return stereo_geometry(
        clock,
        *kepler.shape_and_anomaly(data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]),
        points=data["start_point_b"].shape[1],
        baseline=float(data["baseline"][0]),
        shown=shown_of(data, measures),
        raw_rotation=raw,
        to_camera=_to_camera(data),
    )


def _to_camera(data: Data) -> Array | None:
    if "camera_q_lc" not in data:
        return None
    return quaternion.to_matrix(quaternion.conjugate(data["camera_q_lc"][0]))


def measured_of(data: Data, shown: Shown) -> Array:
    """Return the measurements (run, time, m): slopes point by point, then the acceleration."""
    groups = []
    for name in ("pixel", "flow"):
        if getattr(shown, "pixels" if name == "pixel" else name):
            by_camera = data[f"measured_{name}"]
            rows = np.moveaxis(by_camera, 2, -2)
            groups.append(rows.reshape(*rows.shape[:-2], 4))
    if shown.disparity:
        groups.append(data["measured_disparity"][..., None])
    epochs = data["orbit_position"].shape[:2]
    focal = data["focal_px"][:, None, None]
    flat = [np.concatenate(groups, axis=-1).reshape(*epochs, -1) / focal] if groups else []
    if shown.acceleration:
        flat.append(data["measured_angular_acceleration"])
    return np.concatenate(flat, axis=-1)


def noise_of(data: Data, known: StereoGeometry) -> Array:
    """Return the measurements' known noise (m,), 1 sigma."""
    rows = np.zeros(stereo.ROWS)
    for name, where in (
        ("pixel", stereo.PIXELS),
        ("flow", stereo.FLOW),
        ("disparity", stereo.DISPARITY),
    ):
        if f"{name}_noise" in data:
            rows[where] = data[f"{name}_noise"][0] / data["focal_px"][0]
    noise = np.tile(rows[known.rows], known.points)
    if not known.shown.acceleration:
        return noise
    return np.append(noise, np.repeat(data["angular_acceleration_noise"][0], 3))


def state_of(data: Data, prefix: str = "") -> Array:
    """Return the states (run, ..., n) whose parts carry a prefix; constants at every epoch."""
    moving = [data[f"{prefix}{name}"] for name in ("position", "velocity", "rate_l", "q_lt")]
    leading = moving[0].shape[:-1]
    constant = []
    for name, axes in (("inertia_ratio", 1), ("point_b", 2)):
        values = data[f"{prefix}{name}"]
        flat = values.reshape(*values.shape[: values.ndim - axes], -1)
        if flat.ndim < len(leading) + 1:
            flat = flat[:, None]
        constant.append(np.broadcast_to(flat, (*leading, flat.shape[-1])))
    return np.concatenate([*moving, *constant], axis=-1)


def parts_of(states: Array) -> Data:
    """Return the parts of states, or of sigmas laid out like states, by name."""
    parts: Data = {name: states[..., where] for name, where in NAMES.items()}
    parts["point_b"] = parts["point_b"].reshape(*states.shape[:-1], -1, 3)
    return parts
