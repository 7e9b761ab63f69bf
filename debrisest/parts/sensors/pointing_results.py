"""The closed loop's outcome by the names of the vocabulary."""

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.clock import Clock
from debrisest.control.closed_loop import ClosedLoop, Pointing
from debrisest.control.metrics import section_metrics
from debrisest.control.model_error import drift_mismatch, gain_mismatch
from debrisest.control.rigid_spacecraft import over_time

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


def mismatches(happened: Pointing, loop: ClosedLoop) -> Data:
    """How far the spacecraft are from the controller's model, the worst satellite; NaN if unturned.

    Of the state function the error's root mean square over that of the model, of the input matrix
    the largest value, both at the epochs of all control sections.
    """
    turning: BoolArray = np.asarray(np.isfinite(happened.rate_b[:, :, 0]).all(-1))
    true = happened.angles, np.nan_to_num(happened.rate_b[:, :, 0])
    factors = loop.factors()[:, None, 0]
    measured = true[0] * factors[..., :3], true[1] * factors[..., 3:]
    model, plant = loop.controller.craft, over_time(loop.plant)
    error, modelled = drift_mismatch(model, plant, true, measured)
    above, below = (
        np.sum(np.where(turning[..., None], x**2, 0.0), axis=(1, 3)) for x in (error, modelled)
    )
    delivered = np.asarray(loop.delivered)
    gain = gain_mismatch(
        model, plant, delivered[:, None] if delivered.ndim else 1.0, true[0], measured[0]
    )
    with np.errstate(invalid="ignore"):
        drift = np.sqrt(above / below)
    largest = np.where(turning, gain, -np.inf).max(axis=1)
    return {
        "drift_mismatch": drift.max(axis=-1),
        "gain_mismatch": np.where(np.isfinite(largest), largest, np.nan).max(axis=-1),
    }


def scalars(happened: Pointing, clock: Clock, desired: Array) -> Data:
    """When the first control section begins, and of it the worst satellite; NaN without one.

    NaN too where the scenario ends within it, and the settling time where a satellite has none.
    """
    metrics = section_metrics(happened, 1, clock.step, desired)
    return {
        "first_section": metrics.start,
        "settling_time": metrics.settling_time.max(-1),
        "stage_one_time": metrics.stage_one_time.max(-1),
        "peak_torque": metrics.peak_torque.max(-1),
        "total_variation": metrics.total_variation.max(-1),
        "final_angle": np.abs(metrics.final_angles).max((-2, -1)),
    }
