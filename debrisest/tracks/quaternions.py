"""Checks of quaternions that come from a file: unit norm, and one order throughout.

That the scalar comes last in a whole file cannot be seen from rotations between neighbours: their
angle is twice the arc cosine of ``|p . q|``, which no common order of the components changes. What
shows is a file that changes its order midway, and a target that starts upside down.
"""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.tracks.report import Report

NAMES = ("q0", "q1", "q2", "q3")
_UNIT = 1e-3
_JUMP = 0.5  # rad: a turn between neighbours that is told, if it is ten usual ones


def unit_quaternions(q: Array, lines: IntArray, report: Report) -> Array:
    """Return ``q (row, 4)`` with unit norm; what is off by more than 1e-3 is reported."""
    norm = np.linalg.norm(q, axis=-1)
    say = "norm {:.6g}, not 1 within 0.001: is this a unit quaternion q0 (scalar), q1, q2, q3?"
    report.where(~(np.abs(norm - 1) <= _UNIT), lines, lambda row: say.format(norm[row]), NAMES[0])
    return np.asarray(q / np.where(norm > 0, norm, 1)[:, None])


def check_order(q: Array, lines: IntArray, report: Report) -> tuple[str, ...]:
    """Report rows whose scalar comes last among rows where it comes first; return what to tell.

    A row is such a one if the turn since the row before, far above the median turn, becomes a
    normal one with the scalar taken from the end.
    """
    turn = _angle(q[1:], q[:-1])
    other = _angle(np.roll(q[1:], 1, axis=-1), q[:-1])
    usual = max(float(np.median(turn)), 1e-6) if len(turn) else 0.0
    wrong = (turn > max(10 * usual, 0.1)) & (other < 3 * usual)
    say = "turns by {:.0f} deg since line {}, or by {:.2g} deg with the scalar last; write it first"
    degrees = np.degrees(turn), np.degrees(other)
    report.where(
        np.concatenate([[False], wrong]),
        lines,
        lambda row: say.format(degrees[0][row - 1], lines[row - 1], degrees[1][row - 1]),
        NAMES[0],
    )
    told = []
    if (np.abs(q[:, 3]) > 0.9).all():
        told.append(
            "q3 is above 0.9 throughout: a half turn, or is the scalar last? It must be first"
        )
    jumps = np.flatnonzero(turn > max(10 * usual, _JUMP))
    if jumps.size:
        said = f"turns by {degrees[0][jumps[0]]:.0f} deg up to line {lines[jumps[0] + 1]}"
        told.append(f"{said}, the median is {np.degrees(usual):.2g}: {jumps.size} such jumps")
    return tuple(told)


def _angle(p: Array, q: Array) -> Array:
    return np.asarray(2 * np.arccos(np.clip(np.abs(np.sum(p * q, axis=-1)), 0, 1)))
