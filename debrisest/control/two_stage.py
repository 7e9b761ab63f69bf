"""The controller of one satellite's camera: track the pixel, then hold the attitude.

Source: Li et al., section IV. When to switch and how long to hold the paper does not say; what is
chosen here can be changed. All arrays have the batch axes (run, satellite).
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.control import attitude_hold, pixel_tracking
from debrisest.control.attitude_hold import hold_attitude
from debrisest.control.pixel_tracking import Demand, track_pixel
from debrisest.control.rigid_spacecraft import Spacecraft
from debrisest.control.robust_term import Gains, Reading, Uncertainty

TRACKING, HOLDING, DONE = 0, 1, 2
"""Stages; a satellite that is done holds until the others are done."""


class Switch(NamedTuple):
    """When tracking has done its work, and how long the attitude is held before measuring."""

    pixel: float = 1.5
    """Largest component by which the measured pixel is off."""
    rate: float = 0.01
    """Largest component of the measured rate, rad/s."""
    calm: float = 0.5
    """How long both must be small, s."""
    least: float = 3.0
    most: float = 40.0
    hold: float = 15.0


class Controller(NamedTuple):
    """The law with everything that can be chosen."""

    craft: Spacecraft
    """As the law believes it to be."""
    scale: Array
    """Focal length in pixels, (run, 1)."""
    reading: Reading = "literal"
    tracking: Gains = pixel_tracking.GAINS
    holding: Gains = attitude_hold.GAINS
    uncertainty: Uncertainty = Uncertainty()
    switch: Switch = Switch()
    torque_limit: Array | float = np.inf
    """Of each component, N m, or (run, 1, 1)."""
    anti_windup: bool = True
    """Integrals stand still while the torque is at its limit."""
    desired: Array = pixel_tracking.MIDDLE
    """Pixel (2,) that the target is brought to."""


class Memory(NamedTuple):
    """What the controller keeps from step to step."""

    stage: IntArray
    elapsed: Array
    """In this stage, s."""
    calm: Array
    """Since pixel and rate have been small, s."""
    seen: Array
    """Last pixel that was in view, (..., 2); NaN if none ever was."""
    tracking_integral: Array
    holding_integral: Array
    desired: Array
    """Angles to hold, as measured at the switch, (..., 3)."""


def start(pixel: Array, angles: Array) -> Memory:
    """Return the memory at the start of a control section; without a pixel there is only holding.

    ``pixel (..., 2)`` is the last one seen, ``angles (..., 3)`` are as measured.
    """
    blind = np.isnan(pixel).any(-1)
    zero = np.zeros(blind.shape)
    integrals = np.zeros((*blind.shape, 5)), np.zeros((*blind.shape, 3))
    stage = np.where(blind, HOLDING, TRACKING)
    return Memory(stage, zero, zero, pixel, *integrals, np.array(angles))


def advance(
    controller: Controller, memory: Memory, pixel: Array, angles: Array, rate_b: Array, step: float
) -> tuple[Array, Memory]:
    """Torque ``(..., 3)`` for the next ``step`` seconds, and the memory after it.

    ``pixel (..., 2)`` is NaN where the target is out of view: the last one that was seen counts.
    """
    seen = np.where(np.isnan(pixel), memory.seen, pixel)
    there = _below(seen - controller.desired, controller.switch.pixel)
    memory = _switched(controller.switch, memory._replace(seen=seen), there, angles, rate_b, step)
    tracks = (memory.stage == TRACKING)[..., None]
    some, every = tracks.any(), tracks.all()
    track = _track(controller, memory, rate_b) if some else None
    hold = _hold(controller, memory, angles, rate_b) if not every else None
    if track is None or hold is None:
        chosen = track or hold
        assert chosen is not None
        demanded = chosen.torque
    else:
        demanded = np.where(tracks, track.torque, hold.torque)
    limit = controller.torque_limit
    torque = np.minimum(np.maximum(demanded, -limit), limit)
    free = 1.0 - controller.anti_windup * (torque != demanded).any(-1, keepdims=True)
    if track is not None:
        grown = memory.tracking_integral + step * free * tracks * track.growth
        memory = memory._replace(tracking_integral=grown)
    if hold is not None:
        grown = memory.holding_integral + step * free * ~tracks * hold.growth
        memory = memory._replace(holding_integral=grown)
    return torque, _waited(controller.switch, memory, step)


def _track(controller: Controller, memory: Memory, rate_b: Array) -> Demand:
    return track_pixel(
        controller.craft,
        controller.tracking,
        controller.uncertainty,
        controller.reading,
        np.nan_to_num(memory.seen),
        rate_b,
        memory.tracking_integral,
        controller.scale,
        controller.desired,
    )


def _hold(controller: Controller, memory: Memory, angles: Array, rate_b: Array) -> Demand:
    return hold_attitude(
        controller.craft,
        controller.holding,
        controller.uncertainty,
        controller.reading,
        memory.desired,
        angles,
        rate_b,
        memory.holding_integral,
    )


def _switched(
    switch: Switch, memory: Memory, there: BoolArray, angles: Array, rate_b: Array, step: float
) -> Memory:
    """Memory after tracking has ended where its work is done and the pixel is ``there``."""
    small = there & _below(rate_b, switch.rate)
    calm = np.where(small, memory.calm + step, 0.0)
    tracks = memory.stage == TRACKING
    at_rest = (memory.elapsed > switch.least - 0.5 * step) & (calm > switch.calm - 0.5 * step)
    settled = tracks & (at_rest | (memory.elapsed > switch.most - 0.5 * step))
    if not settled.any():
        return memory._replace(calm=calm)
    return memory._replace(
        stage=memory.stage + settled,
        calm=calm,
        elapsed=np.where(settled, 0.0, memory.elapsed),
        desired=np.where(settled[..., None], angles, memory.desired),
    )


def _waited(switch: Switch, memory: Memory, step: float) -> Memory:
    """Memory after a step, when holding may have lasted long enough."""
    elapsed = memory.elapsed + step
    done = (memory.stage == HOLDING) & (elapsed > switch.hold - 0.5 * step)
    return memory._replace(stage=memory.stage + done, elapsed=elapsed)


def _below(values: Array, limit: float) -> BoolArray:
    return np.asarray(np.abs(values).max(-1) <= limit)
