"""Rows to epochs: equal times are one epoch, and no two rows may contradict each other."""

from dataclasses import dataclass

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.tracks.report import Report

_SAME = 1e-6  # of the typical step: times closer than this are one epoch
_NEAR = 1e-3  # of the typical step: times closer than this are told


@dataclass(frozen=True)
class Epochs:
    """Increasing ``times (epoch,)``, the epoch of each row, and the first line of each epoch."""

    times: Array
    of_row: IntArray
    lines: IntArray
    notes: tuple[str, ...]


def group_times(times: Array, lines: IntArray) -> Epochs:
    """Sort the times of rows ``(row,)`` and join those that differ by rounding only."""
    values, of_row = np.unique(times, return_inverse=True)
    steps = np.diff(values)
    typical = _typical(steps)
    new = np.concatenate([[True], steps >= _SAME * typical])
    of_row = np.asarray(np.cumsum(new) - 1)[of_row]
    first = np.full(int(new.sum()), np.iinfo(np.int64).max)
    np.minimum.at(first, of_row, lines)
    notes = []
    if len(lines) > 1 and (back := np.flatnonzero(np.diff(times) < 0)).size:
        notes.append(f"rows sorted by time: they go back {back.size} times, "
                     f"first in line {lines[back[0] + 1]}")  # fmt: skip
    if joined := len(values) - len(first):
        notes.append(f"{joined} times within a millionth of a step of another are the same epoch")
    near = np.flatnonzero((steps >= _SAME * typical) & (steps < _NEAR * typical))
    if near.size:
        notes.append(f"{near.size} pairs of epochs are less than a thousandth of a step apart, "
                     f"first at {values[near[0]]:.9g} s")  # fmt: skip
    if len(first) < 2:
        notes.append("one epoch only: a motion needs at least two")
    return Epochs(values[new], of_row, first, tuple(notes))


def _typical(steps: Array) -> float:
    """Median of the steps that are no rounding, and of which one gap makes no difference."""
    if not steps.size:
        return 0.0
    return float(np.median(steps[steps >= 1e-3 * np.quantile(steps, 0.99)]))


def scatter(
    index: IntArray, values: Array, size: int, lines: IntArray, report: Report, column: str
) -> Array:
    """Place ``values (row, k)`` at ``index (row,)`` of an array ``(size, k)`` filled with NaN.

    Rows of NaN place nothing. Two rows for one place must agree: a contradiction is reported with
    both lines.
    """
    kept = np.flatnonzero(~np.isnan(values).all(-1) & (index >= 0))
    order = kept[np.argsort(index[kept], kind="stable")]
    again = np.flatnonzero(np.diff(index[order]) == 0)
    first, second = order[again], order[again + 1]
    differ = ~np.isclose(values[first], values[second], rtol=0.0, atol=0.0, equal_nan=True).all(-1)
    report.where(
        differ,
        lines[second],
        lambda at: (
            f"{_shown(values[second[at]])} contradicts {_shown(values[first[at]])} "
            f"in line {lines[first[at]]} for the same time, feature and camera; keep one of them"
        ),
        column,
    )
    result = np.full((size, values.shape[-1]), np.nan)
    result[index[order]] = values[order]
    return result


def _shown(values: Array) -> str:
    return ", ".join(f"{value:.9g}" for value in values)
