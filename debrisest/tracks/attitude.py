"""The chaser's attitude from a file, at the times of the measurements."""

import numpy as np

from debrisest.arrays import Array
from debrisest.errors import UserError
from debrisest.tracks.columns import Layout
from debrisest.tracks.poses import poses_of
from debrisest.tracks.quaternions import NAMES
from debrisest.tracks.sheet import Sheet
from debrisest.tracks.table import read_table
from debrisest.tracks.types import Poses

LAYOUT = Layout(("time_s", *NAMES))


def read_attitude(sheet: Sheet) -> Poses:
    """Attitude ``q_ic`` of ``time_s,q0,q1,q2,q3``: it takes the chaser's axes to inertial ones."""
    table = read_table(sheet, LAYOUT)
    q = np.column_stack([table.numbers[name] for name in NAMES])
    time = table.numbers["time_s"]
    return poses_of(sheet.source, time, q, None, None, table.lines, table.notes)


def attitude_at(attitude: Poses, times: Array) -> Array:
    """Attitude ``(time, 4)`` along the great circle between the two nearest epochs.

    Raises `UserError` where the file does not cover the times; nothing is extrapolated.
    """
    first, last = attitude.times[0], attitude.times[-1]
    outside = times[(times < first) | (times > last)]
    if outside.size:
        span = f"covers {first:.9g} to {last:.9g} s, not {outside[0]:.9g} s"
        raise UserError(f"{attitude.source}: {span}, when something was measured; extend it")
    after = np.clip(np.searchsorted(attitude.times, times), 1, max(len(attitude.times) - 1, 1))
    after = np.minimum(after, len(attitude.times) - 1)
    before = np.maximum(after - 1, 0)
    step = attitude.times[after] - attitude.times[before]
    part = np.divide(times - attitude.times[before], step, out=np.zeros_like(times), where=step > 0)
    return _between(attitude.q[before], attitude.q[after], part[:, None])


def _between(p: Array, q: Array, part: Array) -> Array:
    """Spherical linear interpolation on the shorter arc (Shoemake 1985)."""
    cosine = np.sum(p * q, axis=-1, keepdims=True)
    q, angle = np.where(cosine < 0, -q, q), np.arccos(np.clip(np.abs(cosine), 0, 1))
    sine = np.sin(angle)
    flat = sine < 1e-8
    safe = np.where(flat, 1, sine)
    weight_p = np.where(flat, 1 - part, np.sin((1 - part) * angle) / safe)
    weight_q = np.where(flat, part, np.sin(part * angle) / safe)
    mixed = weight_p * p + weight_q * q
    return np.asarray(mixed / np.linalg.norm(mixed, axis=-1, keepdims=True))
