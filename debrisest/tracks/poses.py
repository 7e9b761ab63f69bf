"""Poses in CSV: the output of a pose network, of PnP or of motion capture."""

from dataclasses import replace

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.tracks.columns import Layout, check_names, together
from debrisest.tracks.epochs import group_times, scatter
from debrisest.tracks.quaternions import NAMES, check_order, unit_quaternions
from debrisest.tracks.report import Report
from debrisest.tracks.rows import POINT
from debrisest.tracks.sheet import Sheet
from debrisest.tracks.table import read_table
from debrisest.tracks.types import Poses

LAYOUT = Layout(("time_s", *NAMES), (*POINT, "sigma_deg"))


def read_poses(sheet: Sheet) -> Poses:
    """Poses of ``time_s,q0,q1,q2,q3[,x_m,y_m,z_m][,sigma_deg]``; a missing row = not seen.

    Raises `UserError`: norms other than 1, contradicting rows, sigmas that are not positive,
    positions of zero written for unknown ones.
    """
    report = Report(sheet.source)
    check_names(sheet.names, sheet.line, LAYOUT, report)
    placed = together(sheet.names, POINT, sheet.line, report)
    report.check()
    table = read_table(sheet, LAYOUT)
    numbers, lines = table.numbers, table.lines
    position = np.column_stack([numbers[n] for n in POINT]) if placed else None
    sigma = np.radians(numbers["sigma_deg"]) if "sigma_deg" in numbers else None
    q = np.column_stack([numbers[name] for name in NAMES])
    return poses_of(sheet.source, numbers["time_s"], q, position, sigma, lines, table.notes)


def poses_of(
    source: str,
    times: Array,
    q: Array,
    position: Array | None,
    sigma_rad: Array | None,
    lines: IntArray,
    notes: tuple[str, ...],
) -> Poses:
    """Poses of rows in any order, checked; ``q (row, 4)`` may be off unit norm by 1e-3."""
    report = Report(source)
    q = unit_quaternions(q, lines, report)
    if position is not None:
        message = "the position is 0, 0, 0, in the camera; leave these columns out if unknown"
        report.where((position == 0).all(-1), lines, message, POINT[0])
    if sigma_rad is not None:
        report.where(~(sigma_rad > 0), lines, "must be positive", "sigma_deg")
    report.check()
    poses = _in_order(Poses(source, times, q, lines, position, sigma_rad, notes), report)
    told = check_order(poses.q, poses.lines, report)
    report.check()
    return replace(poses, notes=poses.notes + told)


def _in_order(rows: Poses, report: Report) -> Poses:
    """One row for each epoch; rows of the same time must agree."""
    epochs = group_times(rows.times, rows.lines)
    size = len(epochs.times)

    def placed(values: Array | None, column: str) -> Array | None:
        if values is None:
            return None
        return scatter(epochs.of_row, values, size, rows.lines, report, column)

    q = placed(rows.q, NAMES[0])
    sigma = placed(rows.sigma_rad[:, None] if rows.sigma_rad is not None else None, "sigma_deg")
    position = placed(rows.position, POINT[0])
    report.check()
    notes = rows.notes + epochs.notes
    if repeated := len(rows.times) - size:
        notes += (f"{repeated} rows repeat another one and are left out",)
    assert q is not None
    return Poses(
        rows.source, epochs.times, q, epochs.lines, position,
        None if sigma is None else sigma[:, 0], notes,
    )  # fmt: skip
