"""Body rates in CSV: of a gyro on the target, or of a network that tells rates."""

import numpy as np

from debrisest.tracks.columns import Layout, check_names
from debrisest.tracks.epochs import group_times, scatter
from debrisest.tracks.report import Report
from debrisest.tracks.sheet import Sheet
from debrisest.tracks.table import read_table
from debrisest.tracks.types import Rates

_NAMES = {
    unit: (*(f"rate_{axis}_{unit}" for axis in "xyz"), f"sigma_{unit}")
    for unit in ("deg_s", "rad_s")
}
COLUMNS = frozenset(name for names in _NAMES.values() for name in names[:3])
"""By which such a file is known."""


def read_rates(sheet: Sheet) -> Rates:
    """Rates of ``time_s,rate_x_deg_s,rate_y_deg_s,rate_z_deg_s[,sigma_deg_s]``, or ``rad_s``.

    Raises `UserError`: units that are mixed, contradicting rows, sigmas that are not positive.
    """
    unit = "rad_s" if "rate_x_rad_s" in sheet.names else "deg_s"
    *rates, sigma = _NAMES[unit]
    layout, report = Layout(("time_s", *rates), (sigma,)), Report(sheet.source)
    check_names(sheet.names, sheet.line, layout, report)
    table = read_table(sheet, layout)
    numbers, lines = table.numbers, table.lines
    columns = [*rates, *([sigma] if sigma in numbers else [])]
    if sigma in numbers:
        report.where(~(numbers[sigma] > 0), lines, "must be positive", sigma)
    report.check()
    rows = np.column_stack([numbers[name] for name in columns])
    epochs = group_times(numbers["time_s"], lines)
    values = scatter(epochs.of_row, rows, len(epochs.times), lines, report, rates[0])
    report.check()
    values = values * (np.pi / 180.0 if unit == "deg_s" else 1.0)
    spread = values[:, 3] if sigma in numbers else None
    notes = table.notes + epochs.notes
    return Rates(sheet.source, epochs.times, values[:, :3], epochs.lines, spread, notes)
