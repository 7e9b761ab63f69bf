"""Times of images: from their numbers and a frame rate, or from a table."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from debrisest.arrays import Array
from debrisest.errors import UserError
from debrisest.tracks.columns import Layout
from debrisest.tracks.sheet import Sheet
from debrisest.tracks.table import read_table

Times = Mapping[str, float]
"""Time, s, of each image by name."""

TIMES = Layout(("filename", "time_s"), texts=frozenset(("filename",)))


def read_times(sheet: Sheet) -> dict[str, float]:
    """Times of ``filename,time_s``. Raises `UserError`, also for an image with two times."""
    table = read_table(sheet, TIMES)
    times: dict[str, float] = {}
    for name, time, line in zip(table.texts["filename"], table.numbers["time_s"], table.lines):
        if times.setdefault(name, float(time)) != time:
            raise UserError(f"{sheet.source}:{line}: filename: {name} has another time above")
    return times


def frame_times(
    names: Sequence[str], source: str, rate_hz: float | None, times: Times | None
) -> tuple[Array, str]:
    """Time ``(image,)`` of each image, and in words where it is from.

    With a rate, the last number in a name counts frames, from zero at the lowest: numbers left out
    are gaps. Raises `UserError` where there is no time, or a name has no number.
    """
    if times is not None:
        if missing := [name for name in names if name not in times]:
            raise UserError(f"{source}: no time is given for {', '.join(missing[:5])}")
        return np.array([times[name] for name in names]), "times from a table"
    if rate_hz is None or not np.isfinite(rate_hz) or rate_hz <= 0:
        message = "images have no times here; give a frame rate in Hz above zero, or a table"
        raise UserError(f"{source}: {message} of filename,time_s")
    numbers = [re.findall(r"[0-9]{1,15}", name.rpartition(".")[0] or name) for name in names]
    if bare := [name for name, found in zip(names, numbers) if not found]:
        raise UserError(f"{source}: {bare[0]} has no frame number; give a table of filename,time_s")
    counts = np.array([int(found[-1]) for found in numbers], dtype=float)
    note = (
        f"times from the images' numbers {counts.min():.0f} to {counts.max():.0f} at {rate_hz:g} Hz"
    )
    return (counts - counts.min()) / rate_hz, note
