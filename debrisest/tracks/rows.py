"""Measurements as rows of any file, and what is wrong with a row by itself."""

import re
from dataclasses import dataclass

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.tracks.report import Report

POINT = ("x_m", "y_m", "z_m")
SIGMA = ("sigma_x_m", "sigma_y_m", "sigma_z_m")
PIXEL = ("u_px", "v_px")


@dataclass(frozen=True)
class Rows:
    """Measurements, a row each: of a feature (-1 = the target as a whole), by a camera (-1 = none).

    ``point`` and ``sigma (row, 3)``, ``pixel (row, 2)`` and ``range (row, 1)`` are NaN where not
    observed, and None where the file has no such column.
    """

    source: str
    time: Array
    feature: IntArray
    camera: IntArray
    lines: IntArray
    features: tuple[str, ...]
    cameras: tuple[str, ...]
    point: Array | None
    sigma: Array | None
    pixel: Array | None
    range: Array | None


def codes(names: list[str]) -> tuple[IntArray, tuple[str, ...]]:
    """Return the code of each name, -1 for none, and the names in natural order (p2, p10)."""
    import pandas as pd

    found, labels = pd.factorize(np.array([name or None for name in names], dtype=object))
    order = sorted(range(len(labels)), key=lambda index: _natural(str(labels[index])))
    rank = np.full(len(labels) + 1, -1)
    rank[order] = np.arange(len(labels))
    return rank[found], tuple(str(labels[index]) for index in order)


def check_rows(rows: Rows, report: Report) -> None:
    """Report incomplete points and pixels, zeros for what was not seen, sigmas and ranges <= 0."""
    for values, names, absent in ((rows.point, POINT, (0.0,)), (rows.pixel, PIXEL, (0.0, -1.0))):
        if values is None:
            continue
        missing = np.isnan(values)
        part = missing.any(-1) & ~missing.all(-1)
        every = ", ".join(names)
        report.where(part, rows.lines, f"give all of {every}, or none")
        for value in absent:
            message = f"{every} are all {value:g}, often written for not seen; leave them empty"
            report.where((values == value).all(-1), rows.lines, message)
    if rows.sigma is not None and rows.point is not None:
        wrong = ~np.isnan(rows.point).any(-1) & ~(rows.sigma > 0).all(-1)
        report.where(wrong, rows.lines, "must be given and positive", "sigma_m")
    if rows.range is not None:
        wrong = rows.range[:, 0] <= 0
        report.where(wrong, rows.lines, "must be positive; empty = not seen", "range_m")
    if rows.pixel is not None:
        wrong = ~np.isnan(rows.pixel[:, 0]) & (rows.camera < 0)
        report.where(wrong, rows.lines, "of which camera is this pixel?", "camera")
    measured = [v for v in (rows.point, rows.pixel, rows.range) if v is not None]
    if all(np.isnan(values).all() for values in measured):
        report.add(int(rows.lines[0]), "nothing was observed, in this row and all others")
    _check_whole(rows, report)


def _check_whole(rows: Rows, report: Report) -> None:
    """Rows without a feature may hold a range only."""
    others = [v for v in (rows.point, rows.pixel) if v is not None]
    held = np.any([~np.isnan(values).all(-1) for values in others], axis=0)
    if rows.range is None:
        held = np.ones(len(rows.lines), bool)
    wrong = (rows.feature < 0) & held
    report.where(wrong, rows.lines, "empty; only a range can do without", "feature")


def _natural(name: str) -> list[tuple[int, int, str]]:
    parts = re.split(r"([0-9]{1,15})", name)
    return [(0, int(part), part) if part.isdecimal() else (1, 0, part) for part in parts]
