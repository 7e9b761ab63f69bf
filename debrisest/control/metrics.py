"""What a control section cost and how fast it was, satellite by satellite."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.control.closed_loop import Pointing
from debrisest.control.pixel_tracking import MIDDLE
from debrisest.control.two_stage import TRACKING

SETTLED = 5.0
"""Largest component by which a settled pixel is off."""


class SectionMetrics(NamedTuple):
    """Of one control section; NaN in runs that have no such section.

    In runs that end within it, NaN but for the start.
    """

    start: Array
    """(run,), s."""
    length: Array
    """(run,), s, a whole number of epochs."""
    settling_time: Array
    """From which on the pixel is settled until tracking ends, s; NaN if it never is."""
    stage_one_time: Array
    """Of tracking, s."""
    peak_torque: Array
    """Largest component, N m."""
    total_variation: Array
    """Sum of a component's steps between control steps, that of the worst component, N m."""
    final_angles: Array
    """When the section ends, (run, satellite, 3), rad."""


def section_metrics(
    pointing: Pointing, number: int, step: float, desired: Array = MIDDLE
) -> SectionMetrics:
    """Return the metrics (run, satellite) of section 1, 3, ...; epochs are ``step`` s apart.

    ``desired (2,)`` is the pixel that the target was to be brought to.
    """
    epochs = pointing.section == number
    has, first, count = epochs.any(1), epochs.argmax(1), epochs.sum(1)
    ended = has & ~epochs[:, -1]
    next_one = np.where(ended, first + count, 0)
    fine = step / pointing.stage.shape[2]
    some = _spanned(epochs)
    stage = pointing.stage[:, some]
    ran = epochs[:, some, None, None] & ~np.isnan(stage)
    torque = _flat(np.where(ran[..., None], pointing.torque[:, some], np.nan))
    tracks = _flat(ran & (stage == TRACKING))
    far = ~(np.abs(_flat(pointing.control_pixel[:, some]) - desired).max(-1) <= SETTLED)
    stage_one = fine * tracks.sum(1)
    before = some.start * pointing.stage.shape[2]
    settling = _time_of_last(tracks & far, fine, before) - first[:, None] * step
    settles = (stage_one > 0.0) & (settling < stage_one - 0.5 * fine)
    size, steps = np.abs(torque), np.abs(np.diff(torque, axis=1))
    return SectionMetrics(
        start=np.where(has, first * step, np.nan),
        length=np.where(ended, count * step, np.nan),
        settling_time=_if(ended[:, None] & settles, np.maximum(settling, 0.0)),
        stage_one_time=_if(ended[:, None], stage_one),
        peak_torque=_if(ended[:, None], np.fmax.reduce(size, 1).max(-1)),
        total_variation=_if(ended[:, None], np.nansum(steps, axis=1).max(-1)),
        final_angles=_if(ended[:, None, None], pointing.angles[np.arange(len(has)), next_one]),
    )


def _spanned(epochs: BoolArray) -> slice:
    """Epochs in which any of the runs (run, time) is in the section; the first, if none ever is."""
    within = np.flatnonzero(epochs.any(0))
    return slice(int(within[0]), int(within[-1]) + 1) if len(within) else slice(0, 1)


def _if(there: BoolArray, values: Array) -> Array:
    return np.where(there, values, np.nan)


def _flat(history: Array) -> Array:
    """From (run, time, substep, ...) to (run, control step, ...)."""
    return history.reshape(len(history), -1, *history.shape[3:])


def _time_of_last(true: BoolArray, step: float, before: int) -> Array:
    """End of the last control step (run, satellite) that is marked; zero where none is.

    So many steps come ``before`` the first.
    """
    count = before + true.shape[1]
    from_end = true[:, ::-1].argmax(1)
    return np.where(true.any(1), (count - from_end) * step, 0.0)
