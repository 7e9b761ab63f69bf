"""What a control section cost and how fast it was, satellite by satellite."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.control.closed_loop import Pointing
from debrisest.control.two_stage import TRACKING

SETTLED = 5.0
"""Largest component of a settled pixel."""


class SectionMetrics(NamedTuple):
    """Of one control section; NaN in runs that have no such section."""

    start: Array
    """(run,), s."""
    length: Array
    """(run,), s, a whole number of epochs."""
    settling_time: Array
    """From which on the pixel is settled until tracking ends, s; if it never is, the length."""
    stage_one_time: Array
    """Of tracking, s."""
    peak_torque: Array
    """Largest component, N m."""
    total_variation: Array
    """Sum of a component's steps between control steps, that of the worst component, N m."""
    final_angles: Array
    """When the section ends, (run, satellite, 3), rad."""


def section_metrics(pointing: Pointing, number: int, step: float) -> SectionMetrics:
    """Return the metrics (run, satellite) of section 1, 3, ...; epochs are ``step`` s apart."""
    epochs = pointing.section == number
    has, first, count = epochs.any(1), epochs.argmax(1), epochs.sum(1)
    length = step * count[:, None]
    last = np.minimum(first + count, epochs.shape[1] - 1)
    fine = step / pointing.stage.shape[2]
    ran = epochs[:, :, None, None] & ~np.isnan(pointing.stage)
    torque = _flat(np.where(ran[..., None], pointing.torque, np.nan))
    tracks = _flat(ran & (pointing.stage == TRACKING))
    far = ~(np.abs(_flat(pointing.control_pixel)).max(-1) <= SETTLED)
    stage_one = fine * tracks.sum(1)
    settling = _time_of_last(tracks & far, fine) - first[:, None] * step
    settles = (stage_one > 0.0) & (settling < stage_one - 0.5 * fine)
    settling = np.where(settles, np.maximum(settling, 0.0), length)
    size, steps = np.abs(torque), np.abs(np.diff(torque, axis=1))
    missing = ~has[:, None]
    return SectionMetrics(
        start=np.where(has, first * step, np.nan),
        length=np.where(has, length[:, 0], np.nan),
        settling_time=np.where(missing, np.nan, settling),
        stage_one_time=np.where(missing, np.nan, stage_one),
        peak_torque=np.where(missing, np.nan, np.fmax.reduce(size, 1).max(-1)),
        total_variation=np.where(missing, np.nan, np.nansum(steps, axis=1).max(-1)),
        final_angles=np.where(
            missing[..., None], np.nan, pointing.angles[np.arange(len(has)), last]
        ),
    )


def _flat(history: Array) -> Array:
    """From (run, time, substep, ...) to (run, control step, ...)."""
    return history.reshape(len(history), -1, *history.shape[3:])


def _time_of_last(true: BoolArray, step: float) -> Array:
    """End of the last control step (run, satellite) that is marked; zero where none is."""
    count = true.shape[1]
    from_end = true[:, ::-1].argmax(1)
    return np.where(true.any(1), (count - from_end) * step, 0.0)
