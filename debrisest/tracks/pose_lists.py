"""Poses in JSON: the lists that come with the public spacecraft-pose data sets.

Sources: SPEED (Sharma and D'Amico 2020) and SPEED+ (Park et al. 2022). There ``q_vbs2tango``, read
as a Hamilton quaternion with the scalar first, takes body vectors into the camera's axes, and
``r_Vo2To_vbs`` is the body's origin in these axes, m: ``x_c = R(q) x_b + r``. The name speaks of
the direction cosine matrix from camera to body, which is the transpose of ``R(q)``.
"""

import json
import re
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from debrisest.arrays import Array
from debrisest.errors import UserError
from debrisest.tracks.frames import Times, frame_times
from debrisest.tracks.numbers import LARGEST
from debrisest.tracks.poses import poses_of
from debrisest.tracks.report import Report
from debrisest.tracks.text import read_text
from debrisest.tracks.types import Poses

_NAME = ("filename", "image", "image_name", "file_name")
_Q = ("q_vbs2tango_true", "q_vbs2tango", "q", "quaternion", "pose_q")
_R = ("r_Vo2To_vbs_true", "r_Vo2To_vbs", "r", "translation", "position", "pose_r")
_TIME = ("time_s",)


def read_pose_list(path: Path, rate_hz: float | None = None, times: Times | None = None) -> Poses:
    """Poses of a JSON list of images, each with a quaternion and, if known, a translation.

    Times are each entry's ``time_s``, or `frame_times`. Raises `UserError` with file and line.
    """
    entries, lines = _entries(path)
    report = Report(str(path))
    taken = [_taken(entry, int(line), report) for entry, line in zip(entries, lines)]
    report.check()
    names, q, r, stamps = zip(*taken)
    position = _same_kind(r, lines, "translation", report)
    given = _same_kind(stamps, lines, "time_s", report)
    report.check()
    if given is not None:
        time, note = given[:, 0], "times from time_s"
    else:
        time, note = frame_times(names, str(path), rate_hz, times)
    notes = (f"{len(q)} poses, quaternions with the scalar first", note)
    return poses_of(str(path), time, np.array(q), position, None, lines, notes)


def _entries(path: Path) -> tuple[list[Any], Any]:
    text = read_text(path)
    try:
        value = json.loads(text, object_pairs_hook=_once, parse_constant=_not_a_number)
    except json.JSONDecodeError as error:
        raise UserError(f"{path}:{error.lineno}:{error.colno}: not JSON: {error.msg}") from None
    except RecursionError:
        raise UserError(f"{path}: not a list of poses: nested too deeply") from None
    except ValueError as error:
        raise UserError(f"{path}: {error}") from None
    if isinstance(value, dict) and value and all(isinstance(v, dict) for v in value.values()):
        value = [{"filename": name} | entry for name, entry in value.items()]
    if not isinstance(value, list) or not value:
        raise UserError(f"{path}: expected a list of images, each with a filename and a quaternion")
    return value, _lines(text, len(value))


def _lines(text: str, count: int) -> Any:
    """Line of each entry, where entries can be counted by a key; else 0, the file."""
    for key in (*_Q, *_NAME):
        found = [match.start() for match in re.finditer(rf'"{re.escape(key)}"\s*:', text)]
        if len(found) == count:
            steps = [text.count("\n", a, b) for a, b in zip([0, *found], found)]
            return np.cumsum(steps) + 1
    return np.zeros(count, dtype=np.int64)


def _taken(entry: Any, line: int, report: Report) -> tuple[str, Any, Any, Any]:
    """Name, quaternion, translation and time of an entry; what is wrong is reported."""
    if not isinstance(entry, dict):
        report.add(line, f"expected an image with its pose, found {str(entry)[:40]!r}")
        return "", [1.0, 0.0, 0.0, 0.0], None, None
    name = _value(entry, _NAME, line, report)
    if not isinstance(name, str):
        report.add(line, f"an image needs its name, as {_NAME[0]}")
    q = _vector(entry, _Q, 4, line, report)
    if q is None:
        report.add(line, f"no quaternion; give {_Q[1]} or quaternion, scalar first")
    stamp = _value(entry, _TIME, line, report)
    stamp = _vector({"time_s": [stamp]}, _TIME, 1, line, report) if stamp is not None else None
    return str(name), q, _vector(entry, _R, 3, line, report), stamp


def _value(entry: dict[str, Any], keys: tuple[str, ...], line: int, report: Report) -> Any:
    there = [key for key in keys if key in entry]
    if len(there) > 1:
        report.add(line, f"{' and '.join(there)} are both there; keep one")
    return entry[there[0]] if there else None


def _vector(entry: Any, keys: tuple[str, ...], size: int, line: int, report: Report) -> Any:
    value = _value(entry, keys, line, report)
    if value is None:
        return None
    numbers = isinstance(value, list) and all(type(x) in (int, float) for x in value)
    if numbers and len(value) == size and all(abs(x) <= LARGEST for x in value):
        return [float(x) for x in value]
    report.add(line, f"expected {size} numbers, found {str(value)[:60]}", keys[0])
    return [1.0] * size


def _same_kind(values: Any, lines: Any, what: str, report: Report) -> Array | None:
    """All entries have it, or none."""
    missing = np.array([value is None for value in values])
    if missing.all():
        return None
    report.where(missing, lines, f"no {what}, which other images have")
    return np.array([[np.nan] if v is None else v for v in values]) if not missing.any() else None


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    entry = dict(pairs)
    if len(entry) < len(pairs):
        names = [name for name, _ in pairs]
        double = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"key {double!r} is there twice in one entry; keep one")
    return entry


def _not_a_number(text: str) -> NoReturn:
    raise ValueError(f"{text} is not a number; leave the image out where nothing was observed")
