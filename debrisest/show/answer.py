"""The answer to a user's file: the motion of the body in about a dozen lines.

A pure function of the stored datasets of a run of the filter `batch`, without their run axis. The
first line says whether torque-free motion is accepted; whatever the data leave undefined is said in
words with the reason.
"""

from collections.abc import Callable

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.batch.motion import Status
from debrisest.show.rounding import rounded, told

_NUMBERS_OF_INERTIA = 5
_STEADY = "the motion does not show them: it turns steadily about one axis"
_LABEL = 15


def answer(data: Data) -> list[str]:
    """Return the answer line by line, values ± 1 sigma, angles in degrees.

    Datasets that are missing have no line; a run that failed has one line, which says why.
    """
    if failure := str(data.get("failure", "")):
        return [f"NO RESULT: {failure}"]
    lines = [_health(data)]
    for label, line in LINES.items():
        text = line(data)
        if text:
            lines.append(f"{label:{_LABEL}}{text}")
    return lines


def accepted(data: Data) -> bool:
    """Return whether both the status and the filter's flag say that torque-free motion holds."""
    status = _status(data)
    return _number(data, "accepted") == 1.0 and (status is None or status.accepted)


def _health(data: Data) -> str:
    status = _status(data)
    said = status.sentence if status is not None else str(data.get("status", ""))
    said = said or "the file does not say how the estimate ended"
    return f"{'accepted' if accepted(data) else 'NOT ACCEPTED'}: {said}"


def _status(data: Data) -> Status | None:
    said = str(data.get("status", ""))
    return next((one for one in Status if said.startswith(one.sentence)), None)


def _judged(data: Data) -> str:
    """Return what is said after the status, by which tests; too few data are not tested."""
    status, said = _status(data), str(data.get("status", ""))
    if status is None or status is Status.TOO_FEW:
        return ""
    return said.removeprefix(status.sentence).lstrip("; ")


def _rate(data: Data) -> str:
    if "speed_end" not in data:
        return ""
    now = _told(data, "speed_end", 180 / np.pi, "deg/s")
    mean = _told(data, "mean_speed", 180 / np.pi, "deg/s")
    return f"{now} at {_end(data):.6g} s, in the mean {mean}"


def _spin_axis(data: Data) -> str:
    return _direction(data, "spin_axis_i")


def _momentum_axis(data: Data) -> str:
    return _direction(data, "momentum_axis_i")


def _nutation(data: Data) -> str:
    if "nutation_angle" not in data:
        return ""
    angle = _told(data, "nutation_angle", 180 / np.pi, "deg")
    period = _told(data, "nutation_period", 1.0, "s")
    if angle == period == "undefined":
        return f"undefined: {_why_not(data)}"
    return f"angle {angle}, period {period}"


def _attitude(data: Data) -> str:
    if "q_if" not in data:
        return ""
    q, spread = data["q_if"][-1], data["q_if_sigma"][-1]
    if not np.isfinite(q).all():
        return f"undefined at {_end(data):.6g} s"
    sigma = 2.0 * float(np.linalg.norm(spread)) / np.sqrt(3.0)
    components = ", ".join(rounded(x, 0.5 * sigma)[0] for x in q)
    off = rounded(np.degrees(sigma), np.degrees(sigma))[1]
    return f"q_if = ({components}) ± {off or '?'} deg per axis at {_end(data):.6g} s"


def _inertia(data: Data) -> str:
    if "moment_share" not in data:
        return ""
    share, sigma = data["moment_share"], data["moment_share_sigma"]
    if not np.isfinite(share[:2]).all():
        return _why_not(data)
    told_of = [told(value, off) for value, off in zip(share[:2], sigma[:2])]
    return f"{told_of[0]} : {told_of[1]} : 1, principal moments over the largest"


def _principal_axes(data: Data) -> str:
    """Return a line only where the ratios are known and the axes are not."""
    q_bf = data.get("q_bf", np.zeros(4))
    known = np.isfinite(data.get("moment_share", np.array([np.nan])))
    if np.isfinite(q_bf).all() or not known.all() or not accepted(data):
        return ""
    return "two moments are equal as far as the data tell: transverse axes undefined"


def _points(data: Data) -> str:
    if "point_f" not in data or not data["point_f"].size:
        return ""
    points, sigma = data["point_f"], data["point_f_sigma"]
    found: BoolArray = np.asarray(np.isfinite(points).all(axis=-1))
    names = [str(name) for name in data.get("feature", np.arange(1, len(points) + 1))]
    lost = [name for name, there in zip(names, found) if not there]
    text = f"{found.sum()} of {len(points)} found"
    if found.any() and (sigma[found] > 0.0).any():
        typical, worst = np.median(sigma[found]), np.max(sigma[found])
        text += f", 1 sigma {typical:.2g} m per axis (largest {worst:.2g} m)"
    elif found.any():
        text += ", places given"
    other = [name for name, there in zip(names, data.get("on_other_body", ())) if there]
    told_of = f"; a second rigid body, which is not estimated: {', '.join(other)}" * bool(other)
    return text + f"; left out: {', '.join(lost)}" * bool(lost) + told_of


def _rejected(data: Data) -> str:
    share = _number(data, "rejected_share")
    if not np.isfinite(share):
        return ""
    return f"{100 * share:.2g} % of the measurements" if share > 0.0 else "no measurement"


def _torque_free(data: Data) -> str:
    begin, end = _number(data, "holds_from"), _number(data, "holds_until")
    if not np.isfinite([begin, end]).all() or not end > begin:
        return ""
    fit = _number(data, "fit")
    of_fit = f", chi-square {fit:.3g} per degree of freedom" if np.isfinite(fit) else ""
    return f"from {begin:.6g} to {end:.6g} s of {_end(data):.6g} s{of_fit}"


LINES: dict[str, Callable[[Data], str]] = {
    "rate": _rate,
    "spin axis": _spin_axis,
    "momentum axis": _momentum_axis,
    "nutation": _nutation,
    "attitude": _attitude,
    "inertia": _inertia,
    "axes": _principal_axes,
    "points": _points,
    "rejected": _rejected,
    "torque-free": _torque_free,
    "judged": _judged,
}


def _why_not(data: Data) -> str:
    """Return why the inertia, or what follows from it, is undefined."""
    status, lost = _status(data), int(np.nan_to_num(_number(data, "lost_directions")))
    if status is Status.TOO_FEW:
        return "too few data"
    if status is Status.NOT_TORQUE_FREE:
        return f"no inertia: {_until(data)}"
    if status is Status.WITHOUT_INERTIA or lost == _NUMBERS_OF_INERTIA:
        return _STEADY
    if lost:
        shown = _NUMBERS_OF_INERTIA - lost
        return f"the motion shows {shown} of the {_NUMBERS_OF_INERTIA} numbers of the inertia only"
    return "the data leave it uncertain by half its value or more"


def _until(data: Data) -> str:
    begin, end = _number(data, "holds_from"), _number(data, "holds_until")
    if not np.isfinite([begin, end]).all() or not end > begin:
        return "torque-free motion explains no stretch of the data"
    late = f"before {begin:.6g} s and " if begin > data["time_s"][0] else ""
    return f"torque-free motion fails {late}from {end:.6g} s"


def _direction(data: Data, name: str) -> str:
    if name not in data:
        return ""
    axis, sigma = data[name], data[f"{name}_sigma"]
    angle = float(np.degrees(np.linalg.norm(sigma)))
    off = rounded(angle, angle)[1]
    if not np.isfinite(axis).all():
        return "undefined" + f": may be off by {off} deg" * bool(off)
    components = ", ".join(rounded(x, np.radians(angle))[0] for x in axis)
    return f"({components}) ± {off or '?'} deg, inertial"


def _told(data: Data, name: str, scale: float, unit: str) -> str:
    value, sigma = _number(data, name), _number(data, f"{name}_sigma")
    return told(scale * value, scale * sigma, unit)


def _number(data: Data, name: str) -> float:
    """Return a dataset that is one number, NaN where it is missing."""
    value: Array = np.asarray(data.get(name, np.nan), dtype=np.float64)
    return float(value)


def _end(data: Data) -> float:
    return float(data["time_s"][-1])
