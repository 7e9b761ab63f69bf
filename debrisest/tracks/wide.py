"""Tracks in wide CSV: a row for each time, a group of columns for each feature.

Columns are named ``FEATURE_x_m``, ``FEATURE_y_m``, ``FEATURE_z_m`` with ``FEATURE_sigma_m`` or
``FEATURE_sigma_x_m`` ..., ``FEATURE_u_px``, ``FEATURE_v_px`` (``FEATURE@CAMERA_u_px`` with several
cameras) and ``FEATURE_range_m``, or one ``range_m`` for the target. Empty cells = not seen.
"""

import re
from collections.abc import Iterable

import numpy as np

from debrisest.arrays import Array
from debrisest.tracks.assemble import assemble
from debrisest.tracks.columns import Layout
from debrisest.tracks.points import ONE_CAMERA, measured
from debrisest.tracks.report import Report
from debrisest.tracks.rows import PIXEL, POINT, SIGMA, Rows, codes
from debrisest.tracks.sheet import Sheet
from debrisest.tracks.table import Table, read_table
from debrisest.tracks.types import Tracks

_SUFFIXES = (*POINT, "sigma_m", *SIGMA, *PIXEL, "range_m")
_NAME = re.compile(rf"(?P<feature>[^@]+?)(@(?P<camera>.+))?_(?P<what>{'|'.join(_SUFFIXES)})")

Group = tuple[str, str]
"""Feature and camera ('' for none) of the columns that share a prefix."""


def is_wide(names: Iterable[str]) -> bool:
    """Return whether a header has groups of columns by feature."""
    return any(_NAME.fullmatch(name) for name in names if name not in _SUFFIXES)


def read_wide(sheet: Sheet) -> Tracks:
    """Tracks of a table with a row for each time. Raises `UserError`."""
    groups = _groups(sheet)
    known = tuple(
        column
        for feature, camera in groups
        for column in (f"{_prefix(feature, camera)}_{suffix}" for suffix in _SUFFIXES)
    )
    layout = Layout(("time_s",), ("range_m", *known), gaps=frozenset(("range_m", *known)))
    table = read_table(sheet, layout)
    report = Report(sheet.source)
    for group, suffixes in groups.items():
        measured(tuple(suffixes), sheet.line, report, _prefix(*group))
    return assemble(_rows(sheet, table, groups), table.notes)


def _groups(sheet: Sheet) -> dict[Group, list[str]]:
    """Suffixes of each group of columns, in the header's order."""
    groups: dict[Group, list[str]] = {}
    for name in sheet.names:
        if (match := _NAME.fullmatch(name)) and name not in _SUFFIXES:
            group = (match["feature"], match["camera"] or "")
            groups.setdefault(group, []).append(match["what"])
    return groups


def _prefix(feature: str, camera: str) -> str:
    return f"{feature}@{camera}" if camera else feature


def _rows(sheet: Sheet, table: Table, groups: dict[Group, list[str]]) -> Rows:
    """The same table with a row for each time and group."""
    count, numbers = len(table.lines), table.numbers
    every = [*groups, *([("", "")] if "range_m" in numbers else [])]

    def stacked(*suffixes: str) -> Array | None:
        columns = [
            [numbers.get(f"{_prefix(*group)}_{s}" if group[0] else s) for s in suffixes]
            for group in every
        ]
        if all(column is None for block in columns for column in block):
            return None
        empty = np.full(count, np.nan)
        blocks = [np.stack([empty if c is None else c for c in b], axis=-1) for b in columns]
        return np.concatenate(blocks)

    feature, features = codes([feature for feature, _ in every])
    shown = [c or (ONE_CAMERA if PIXEL[0] in groups.get((f, c), ()) else "") for f, c in every]
    camera, cameras = codes(shown)
    one, three = stacked("sigma_m", "sigma_m", "sigma_m"), stacked(*SIGMA)
    sigma = one if three is None else three if one is None else np.where(np.isnan(one), three, one)
    return Rows(
        sheet.source, np.tile(numbers["time_s"], len(every)), np.repeat(feature, count),
        np.repeat(camera, count), np.tile(table.lines, len(every)), features, cameras,
        stacked(*POINT), sigma, stacked(*PIXEL), stacked("range_m"),
    )  # fmt: skip
