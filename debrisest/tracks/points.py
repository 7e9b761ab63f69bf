"""Tracks in long CSV: a row for each feature at each time."""

import numpy as np

from debrisest.arrays import Array
from debrisest.tracks.assemble import assemble
from debrisest.tracks.columns import Layout, check_names, together
from debrisest.tracks.report import Report
from debrisest.tracks.rows import PIXEL, POINT, SIGMA, Rows, codes
from debrisest.tracks.sheet import Sheet
from debrisest.tracks.table import read_table
from debrisest.tracks.types import Tracks

LAYOUT = Layout(
    ("time_s", "feature"),
    (*POINT, "sigma_m", *SIGMA, "camera", *PIXEL, "range_m"),
    frozenset(("feature", "camera")),
    frozenset(("feature", *POINT, "sigma_m", *SIGMA, "camera", *PIXEL, "range_m")),
)
ONE_CAMERA = "camera"
"""Name of the camera of a file that names none."""


def read_long(sheet: Sheet) -> Tracks:
    """Tracks of ``time_s,feature`` with points, pixels and/or ranges; a missing row = not seen.

    Without ``camera`` all pixels are of one camera. Raises `UserError`.
    """
    report = Report(sheet.source)
    check_names(sheet.names, sheet.line, LAYOUT, report)
    points, pixels, sigma = measured(sheet.names, sheet.line, report)
    table = read_table(sheet, LAYOUT)
    feature, features = codes(table.texts["feature"])
    camera, cameras = codes(
        table.texts.get("camera", [ONE_CAMERA if pixels else ""] * len(feature))
    )
    numbers = table.numbers
    stacked: dict[str, Array] = {n: v[:, None] for n, v in numbers.items()}
    rows = Rows(
        sheet.source, numbers["time_s"], feature, camera, table.lines, features,
        cameras if pixels else (),
        np.hstack([stacked[n] for n in POINT]) if points else None,
        np.hstack([stacked[n] for n in sigma]) if sigma else None,
        np.hstack([stacked[n] for n in PIXEL]) if pixels else None,
        stacked.get("range_m"),
    )  # fmt: skip
    return assemble(rows, table.notes)


def measured(
    names: tuple[str, ...], line: int, report: Report, of: str = ""
) -> tuple[bool, bool, tuple[str, ...]]:
    """Whether there are points, pixels, and the three columns of sigma (one thrice, or none).

    What does not go together is reported, as a problem ``of`` a feature.
    """
    points = together(names, POINT, line, report, of)
    pixels = together(names, PIXEL, line, report, of)
    axes, one = together(names, SIGMA, line, report, of), "sigma_m" in names
    if axes and one:
        report.add(line, f"sigma_m and {SIGMA[0]} are both there; keep one sigma or three", of)
    if (axes or one) and not points:
        report.add(line, f"a sigma without points; {', '.join(POINT)} are missing", of)
    if "camera" in names and not pixels:
        report.add(line, f"camera without {', '.join(PIXEL)}", of)
    if not (points or pixels or "range_m" in names or report.count):
        columns = f"{', '.join(POINT)} or {', '.join(PIXEL)} or range_m"
        report.add(line, f"nothing measured: give {columns}", of)
    report.check()
    return points, pixels, SIGMA if axes else ("sigma_m",) * 3 if one else ()
