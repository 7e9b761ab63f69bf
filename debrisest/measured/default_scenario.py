"""The default scenario of measured data: the estimator of what they hold."""

from collections.abc import Mapping
from typing import Any

from debrisest.arrays import Data
from debrisest.catalog import CATALOG, kind_of
from debrisest.errors import UserError

Text = dict[str, Any]
"""What stands in a YAML file."""

_HELD = {
    "measured_point": "points",
    "measured_q_if": "attitudes",
    "measured_rate_f": "rates",
    "measured_pixel": "pixels",
    "measured_range": "ranges",
    "landmark_range": "ranges",
    "known_point_f": "the geometry of the points",
}


def default_scenario(title: str, measured: Mapping[str, Any], data: Data) -> Text:
    """Return a scenario with the default estimator of what ``data`` hold.

    ``measured`` is the part that gives the data, as in YAML. Raises `UserError` where the data
    serve no estimator, with what is missing.
    """
    return {
        "title": title,
        "measured": dict(measured),
        "estimators": {"batch": _default_estimator(data)},
    }


def _default_estimator(data: Data) -> Text:
    problem: Text = {"kind": "tumbling_motion"}
    known, recovery = "known_point_f" in data, None
    if "measured_point" not in data and "measured_pixel" in data:
        cameras = data["measured_pixel"].shape[2]
        recovery = "pixel_pose" if known else "triangulation" if cameras > 1 else None
    if "measured_q_if" in data or recovery == "pixel_pose":
        problem["measured"] = "attitudes"
    elif "measured_rate_f" in data:
        problem["measured"] = "rates"
    elif "measured_point" not in data and recovery is None:
        raise UserError(_serves_nothing(data))
    elif not known:
        problem["geometry"] = "unknown"
    first = {"recovery": {"kind": recovery}} if recovery else {}
    return first | {"problem": problem, "filter": {"kind": "batch"}}


def _serves_nothing(data: Data) -> list[str]:
    """Say what is there, what is missing, and which problems it would fit with more."""
    held = ", ".join(dict.fromkeys(word for name, word in _HELD.items() if name in data))
    missing = "points, attitudes, or pixels with a calibration"
    if "measured_pixel" in data:
        missing = "the geometry of the points (points), or the pixels of a second camera"
    told = [f"nothing can be estimated from {held} alone; what is missing: {missing}"]
    for part in CATALOG["problem"]:
        if not any(name in data for name in part.needs if name.startswith("measured_")):
            continue
        lacking = ", ".join(name for name in part.needs if name not in data)
        told.append(f"problem {kind_of(part)} would fit with these datasets too: {lacking}")
    return told
