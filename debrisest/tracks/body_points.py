"""Known geometry of a target: its features in body axes."""

import numpy as np

from debrisest.tracks.columns import Layout
from debrisest.tracks.report import Report
from debrisest.tracks.rows import POINT
from debrisest.tracks.sheet import Sheet
from debrisest.tracks.table import read_table
from debrisest.tracks.types import BodyPoints

LAYOUT = Layout(("feature", *POINT), texts=frozenset(("feature",)))


def read_body_points(sheet: Sheet) -> BodyPoints:
    """Points of ``feature,x_m,y_m,z_m``. Raises `UserError` for a feature that is there twice."""
    table = read_table(sheet, LAYOUT)
    report, features = Report(sheet.source), table.texts["feature"]
    first: dict[str, int] = {}
    for name, line in zip(features, table.lines.tolist()):
        if (other := first.setdefault(name, line)) != line:
            report.add(line, f"{name} is there twice, first in line {other}", "feature")
    report.check()
    points = np.column_stack([table.numbers[name] for name in POINT])
    return BodyPoints(sheet.source, tuple(features), points, table.notes)
