"""Tracks, poses and body points to the files that this package reads; numbers keep all digits."""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from debrisest.arrays import Array
from debrisest.files import replacing
from debrisest.tracks.quaternions import NAMES
from debrisest.tracks.rows import PIXEL, POINT, SIGMA
from debrisest.tracks.types import BodyPoints, Poses, Tracks


def write_long(path: Path, tracks: Tracks) -> None:
    """Write tracks with a row for each feature and camera at each time; unseen ones have none."""
    numbers = [(POINT, tracks.points), (SIGMA, tracks.point_sigma)]
    names = [n for group, values in numbers if values is not None for n in group]
    whole = tracks.ranges is not None and tracks.ranges.ndim == 1
    header = ["time_s", "feature", *names, *(["range_m"] if tracks.ranges is not None else [])]
    rows: list[list[str]] = []
    for epoch, time in enumerate(tracks.times):
        if whole and tracks.ranges is not None:
            rows.append([_text(time), "", *[""] * len(names), _text(tracks.ranges[epoch])])
        for index, feature in enumerate(tracks.features):
            cells = [_text(x) for _, v in numbers if v is not None for x in v[epoch, index]]
            if tracks.ranges is not None:
                cells.append("" if whole else _text(tracks.ranges[epoch, index]))
            rows.append([_text(time), feature, *cells])
    if tracks.pixels is not None:
        header += ["camera", *PIXEL]
        rows = [[*row, "", "", ""] for row in rows] + _pixel_rows(tracks, len(header) - 5)
    _write(path, header, (row for row in rows if any(row[2:])))


def write_wide(path: Path, tracks: Tracks) -> None:
    """Write tracks with a row for each time; cells are empty where a feature is not seen."""
    header, columns = ["time_s"], [tracks.times]
    for names, values in ((POINT, tracks.points), (SIGMA, tracks.point_sigma)):
        for index, feature in enumerate(tracks.features if values is not None else ()):
            header += [f"{feature}_{name}" for name in names]
            columns += [*values[:, index].T] if values is not None else []
    for camera, name in enumerate(tracks.cameras if tracks.pixels is not None else ()):
        for index, feature in enumerate(tracks.features):
            header += [f"{feature}@{name}_{pixel}" for pixel in PIXEL]
            columns += [*tracks.pixels[:, camera, index].T] if tracks.pixels is not None else []
    if tracks.ranges is not None and tracks.ranges.ndim == 1:
        header, columns = [*header, "range_m"], [*columns, tracks.ranges]
    elif tracks.ranges is not None:
        header += [f"{feature}_range_m" for feature in tracks.features]
        columns += [*tracks.ranges.T]
    _write(path, header, _rows(columns))


def write_poses(path: Path, poses: Poses) -> None:
    """Write poses, with positions and sigma where there are any."""
    header, columns = ["time_s", *NAMES], [poses.times, *poses.q.T]
    if poses.position is not None:
        header, columns = [*header, *POINT], [*columns, *poses.position.T]
    if poses.sigma_rad is not None:
        header, columns = [*header, "sigma_deg"], [*columns, np.degrees(poses.sigma_rad)]
    _write(path, header, _rows(columns))


def write_body_points(path: Path, body: BodyPoints) -> None:
    """Write the known geometry."""
    rows = ([name, *map(_text, point)] for name, point in zip(body.features, body.points))
    _write(path, ["feature", *POINT], rows)


def write_pose_list(path: Path, poses: Poses) -> None:
    """Write poses in JSON as the public data sets do, with a ``time_s`` each."""
    entries = [
        {"filename": f"img{index:06d}.jpg", "time_s": float(time)}
        | {"q_vbs2tango_true": poses.q[index].tolist()}
        | (
            {"r_Vo2To_vbs_true": poses.position[index].tolist()}
            if poses.position is not None
            else {}
        )
        for index, time in enumerate(poses.times)
    ]
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(entries, indent=1) + "\n")


def _pixel_rows(tracks: Tracks, blank: int) -> list[list[str]]:
    assert tracks.pixels is not None
    return [
        [
            _text(time),
            feature,
            *[""] * blank,
            name,
            *map(_text, tracks.pixels[epoch, camera, index]),
        ]
        for epoch, time in enumerate(tracks.times)
        for camera, name in enumerate(tracks.cameras)
        for index, feature in enumerate(tracks.features)
        if not np.isnan(tracks.pixels[epoch, camera, index]).any()
    ]


def _rows(columns: Sequence[Array]) -> Iterable[list[str]]:
    return ([_text(value) for value in row] for row in zip(*columns))


def _text(value: float) -> str:
    return "" if np.isnan(value) else repr(float(value))


def _write(path: Path, header: list[str], rows: Iterable[list[str]]) -> None:
    lines = [",".join(_quoted(cell) for cell in row) for row in (header, *rows)]
    with replacing(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _quoted(cell: str) -> str:
    return f'"{cell}"' if any(mark in cell for mark in ",;\t#") else cell
