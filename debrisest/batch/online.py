"""The batch again and again on the data so far: estimates that know nothing of later epochs.

Nothing is handed over, so nothing is counted twice or linearised once and for all; between two
runs the motion is predicted in closed form. A run begins where the last one ended, and searches
anew only where the data then speak against it.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.motion import Motion
from debrisest.batch.motion_model import Estimate
from debrisest.batch.path import Path

_LEAST_WAIT = 10.0  # s
_LEAST_SHARE = 0.1  # of the time so far


class Stretch(NamedTuple):
    """Some epochs in a row, and the motion that was known there."""

    motion: Motion
    """From the data up to the first of them."""
    path: Path
    """At these epochs."""


def online(estimate: Estimate, times: Array) -> Iterator[Stretch]:
    """Yield the stretches of one run; nothing is known before the first of them.

    The last one is the last epoch alone, with the motion from all data.
    """
    near = None
    ends = epochs_of_runs(times)
    for first, after in zip(ends, [*ends[1:], len(times)]):
        motion = estimate(first + 1, near, times[first:after] if after < len(times) else None)
        near = motion.arc if motion.status.accepted else None
        yield Stretch(motion, motion.path.at(slice(first - after, None)))


def epochs_of_runs(times: Array) -> list[int]:
    """Return the epochs at which the batch is run: every 10 s, later every tenth of the time."""
    chosen, now = [], float(times[0])
    while now < times[-1]:
        now += max(_LEAST_WAIT, _LEAST_SHARE * (now - float(times[0])))
        chosen.append(int(np.searchsorted(times, min(now, times[-1]))))
    return sorted({*chosen, len(times) - 1})
