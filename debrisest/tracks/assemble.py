"""From rows of measurements to tracks, with everything checked that rows can tell."""

from dataclasses import replace

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.files import alike
from debrisest.tracks.epochs import Epochs, group_times, scatter
from debrisest.tracks.report import Report
from debrisest.tracks.rows import PIXEL, POINT, Rows, check_rows
from debrisest.tracks.types import Tracks


def assemble(rows: Rows, notes: tuple[str, ...] = ()) -> Tracks:
    """Tracks of rows in any order.

    Raises `UserError`, with lines: contradicting rows, incomplete points or pixels, sigmas that are
    missing or not positive, zeros written for what was not seen, times that no features share.
    """
    report = Report(rows.source)
    check_rows(rows, report)
    report.check()
    epochs = group_times(rows.time, rows.lines)
    shape = (len(epochs.times), len(rows.features))
    place = np.where(rows.feature >= 0, epochs.of_row * shape[1] + rows.feature, -1)
    size = shape[0] * shape[1]

    def placed(values: Array | None, column: str) -> Array | None:
        if values is None:
            return None
        return scatter(place, values, size, rows.lines, report, column).reshape(*shape, -1)

    tracks = Tracks(
        rows.source, epochs.times, rows.features, epochs.lines,
        placed(rows.point, POINT[0]), placed(rows.sigma, "sigma_m"),
        rows.cameras, _pixels(rows, epochs, report), _ranges(rows, epochs, place, report),
        notes + epochs.notes + _duplicates(rows) + _told(rows),
    )  # fmt: skip
    alone = _alone(tracks, report)
    report.check()
    return replace(tracks, notes=tracks.notes + alone)


def _pixels(rows: Rows, epochs: Epochs, report: Report) -> Array | None:
    if rows.pixel is None:
        return None
    shape = (len(epochs.times), len(rows.cameras), len(rows.features))
    place = (epochs.of_row * shape[1] + rows.camera) * shape[2] + rows.feature
    place = np.where((rows.camera >= 0) & (rows.feature >= 0), place, -1)
    size = int(np.prod(shape))
    return scatter(place, rows.pixel, size, rows.lines, report, PIXEL[0]).reshape(*shape, 2)


def _ranges(rows: Rows, epochs: Epochs, place: IntArray, report: Report) -> Array | None:
    """Ranges to the target as a whole (no feature, or the same for all of them) or by feature."""
    if rows.range is None:
        return None
    shape = (len(epochs.times), len(rows.features))
    seen, whole = ~np.isnan(rows.range[:, 0]), rows.feature < 0
    if (seen & whole).any():
        message = "of a feature, while other rows have ranges of the target as a whole"
        report.where(seen & ~whole, rows.lines, message, "range_m")
        index = np.where(whole, epochs.of_row, -1)
        return scatter(index, rows.range, shape[0], rows.lines, report, "range_m")[:, 0]
    ranges = scatter(place, rows.range, shape[0] * shape[1], rows.lines, report, "range_m")
    ranges = ranges.reshape(shape)
    known = ~np.isnan(ranges)
    least = np.min(ranges, axis=1, where=known, initial=np.inf)
    most = np.max(ranges, axis=1, where=known, initial=-np.inf)
    if (known.sum(1) > 1).any() and (least >= most).all():
        return np.where(np.isfinite(least), least, np.nan)
    return ranges


def _duplicates(rows: Rows) -> tuple[str, ...]:
    """Rows that say again what another one says (contradictions are refused elsewhere)."""
    import pandas as pd

    parts = [v for v in (rows.point, rows.sigma, rows.pixel, rows.range) if v is not None]
    keys = np.column_stack([rows.time, rows.feature, rows.camera, *parts])
    again = pd.DataFrame(keys).duplicated().to_numpy()
    if not again.any():
        return ()
    first = rows.lines[np.flatnonzero(again)[0]]
    return (f"{int(again.sum())} rows repeat another one and are left out, first line {first}",)


def _told(rows: Rows) -> tuple[str, ...]:
    notes = []
    if len(rows.features) < 3 and rows.point is not None:
        notes.append(f"{len(rows.features)} features only: an attitude needs three, not in line")
    folded: dict[str, str] = {}
    for name in rows.features:
        if (other := folded.setdefault(alike(name), name)) != name:
            pair = f"features {other} and {name}"
            notes.append(f"{pair} differ in capitals or accents only: are they the same?")
    once = np.bincount(rows.feature[rows.feature >= 0], minlength=len(rows.features)) == 1
    if once.any() and len(rows.lines) > len(rows.features):
        names = [name for name, single in zip(rows.features, once) if single]
        notes.append(f"seen in one row only: {', '.join(names[:10])}; are the names right?")
    given = np.zeros(0) if rows.sigma is None else rows.sigma
    sigma = np.unique(given[~np.isnan(given)])
    if len(sigma) == 1:
        notes.append(f"sigma is {sigma[0]:g} m for all points")
    return tuple(notes)


def _alone(tracks: Tracks, report: Report) -> tuple[str, ...]:
    """Features of a rigid body are seen together; a column in the place of time shows here."""
    seen = np.zeros((len(tracks.times), len(tracks.features)), bool)
    if tracks.points is not None:
        seen |= ~np.isnan(tracks.points[..., 0])
    if tracks.pixels is not None:
        seen |= ~np.isnan(tracks.pixels[..., 0]).all(1)
    alone = np.flatnonzero(seen.sum(1) == 1)
    if len(tracks.features) == 1 or not alone.size:
        return ()
    if seen.sum(1).max() == 1:
        message = "no two features share a time; is another column in its place?"
        report.add(int(tracks.lines[0]), message, "time_s")
    line = tracks.lines[alone[0]]
    return (f"{alone.size} epochs show one feature only, first in line {line}; is its time right?",)
