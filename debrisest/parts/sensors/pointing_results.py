"""The closed loop's outcome by the names of the vocabulary."""

import numpy as np

from debrisest.arrays import BoolArray, Data
from debrisest.clock import Clock
from debrisest.control.closed_loop import Pointing
from debrisest.control.metrics import section_metrics

_KEPT = "in view of every camera at each epoch"
_LOST = "not in view of every camera at each epoch"
_NEVER = "in view of no camera at any epoch"


def epochs(happened: Pointing) -> Data:
    """What there is at every epoch, and how it went in words, which leave out the time between."""
    seen: BoolArray = np.asarray(~np.isnan(happened.pixel).any(-1))
    words = np.where(seen.all((1, 2)), _KEPT, np.where(seen.any((1, 2)), _LOST, _NEVER))
    return {
        "true_euler": happened.angles,
        "section": happened.section.astype(np.float64),
        "true_pixel": happened.pixel,
        "pointing_status": words,
    }


def history(happened: Pointing, clock: Clock, every: int) -> Data:
    """Each ``every``-th control step of the whole scenario."""
    substeps = happened.torque.shape[2]
    kept = np.arange(0, len(clock.times) * substeps, every)
    torque, pixel = (
        x.reshape(len(x), -1, *x.shape[3:])[:, kept]
        for x in (happened.torque, happened.control_pixel)
    )
    times = kept * (clock.step / substeps)
    return {"control_time_s": times, "torque": torque, "control_pixel": pixel}


def scalars(happened: Pointing, clock: Clock) -> Data:
    """When the first control section begins, and of it the worst satellite; NaN without one.

    NaN too where the scenario ends within it, and the settling time where a satellite has none.
    """
    metrics = section_metrics(happened, 1, clock.step)
    return {
        "first_section": metrics.start,
        "settling_time": metrics.settling_time.max(-1),
        "stage_one_time": metrics.stage_one_time.max(-1),
        "peak_torque": metrics.peak_torque.max(-1),
        "total_variation": metrics.total_variation.max(-1),
        "final_angle": np.abs(metrics.final_angles).max((-2, -1)),
    }
