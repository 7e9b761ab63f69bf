"""The closed loop of several satellites: measure until the target nears an image's edge, then turn.

Estimation sections advance by the scenario's step and hold the attitude, control sections by
control steps.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.attitude import euler, quaternion
from debrisest.control import schedule, turning, two_stage
from debrisest.control.camera import Camera
from debrisest.control.rigid_spacecraft import Spacecraft, reference_rate_b
from debrisest.control.schedule import State
from debrisest.control.track import Track, between
from debrisest.control.two_stage import Controller

Frozen = Literal["local", "inertial"]
"""Axes in which the attitude stands still between the control sections."""

Factors = Callable[[], Array]
"""What the measured angles and rates of an epoch are multiplied by, (run, substep, satellite, 6);
called once an epoch, in order."""


class Pointing(NamedTuple):
    """What happened; NaN where nothing did."""

    section: IntArray
    """(run, time): 0, 2, ... estimation, 1, 3, ... control."""
    angles: Array
    """(run, time, satellite, 3), rad, from local orbital axes."""
    pixel: Array
    """(run, time, satellite, 2), NaN out of view."""
    stage: Array
    """(run, time, substep, satellite)."""
    control_pixel: Array
    """(run, time, substep, satellite, 2) at the start of each control step, out of view too."""
    torque: Array
    """(run, time, substep, satellite, 3), N m, during each control step."""
    rate_b: Array
    """(run, time, substep, satellite, 3), rad/s, at its start."""


@dataclass(frozen=True)
class ClosedLoop:
    """Controller, camera and spacecraft about a target's track."""

    controller: Controller
    camera: Camera
    plant: Spacecraft
    """As it really is; the controller has its own belief."""
    track: Track
    step: float
    """Between epochs, s."""
    substeps: int
    """Control steps between epochs."""
    factors: Factors
    turning_axes: bool = False
    """Whether the local axes' turning moves the spacecraft in them (Li et al. leave it out)."""
    frozen: Frozen = "local"
    delivered: Array | float = 1.0
    """Share of the demanded torques that acts, (run, satellite, 3)."""

    def run(self, angles0: Array) -> Pointing:
        """Return what happens from the angles ``angles0 (run, satellite, 3)`` on.

        A controller that makes the spacecraft tumble ends in pixels out of view or in NaN.
        """
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self._run(angles0)

    def in_view(self, angles: Array) -> BoolArray:
        """Where (run, satellite) the target is in view at the first epoch."""
        return self.camera.shown(self.track.point_o[:, 0], angles)[1]

    def _run(self, angles0: Array) -> Pointing:
        runs, epochs, satellites = self.track.point_o.shape[:3]
        result = _empty(runs, epochs, self.substeps, satellites)
        shown = self.camera.shown(self.track.point_o[:, 0], angles0)
        state = schedule.first(self.camera.measured(shown), angles0)
        for epoch in range(epochs):
            factors = self.factors()
            pixel, visible = self.camera.shown(self.track.point_o[:, epoch], state.angles)
            if epoch > 0:
                measured = state.angles * factors[:, 0, :, :3]
                seen, at_rest = self.camera.measured((pixel, visible)), self._at_rest(epoch, state)
                state = schedule.scheduled(state, self.camera, seen, measured, at_rest)
            result.section[:, epoch], result.angles[:, epoch] = state.section, state.angles
            result.pixel[:, epoch] = np.where(visible[..., None], pixel, np.nan)
            if epoch + 1 < epochs:
                state = self._advanced(epoch, state, factors, result)
        return result

    def _at_rest(self, epoch: int, state: State) -> Array:
        """Body rate of a satellite whose attitude stood still."""
        if not self.turning_axes or self.frozen == "inertial":
            return np.zeros_like(state.rate_b)
        return reference_rate_b(state.angles, self.track.rate_o[:, epoch])

    def _advanced(self, epoch: int, state: State, factors: Array, result: Pointing) -> State:
        """The state at the next epoch."""
        waiting = state.angles
        if self.frozen == "inertial":
            waiting = _left_behind(waiting, self.track.rate_o[:, epoch] * self.step)
        if not state.turning.any():
            return state._replace(angles=waiting)
        return state.turned(self._turned(epoch, state, factors, result), waiting)

    def _turned(self, epoch: int, state: State, factors: Array, result: Pointing) -> State:
        """The state after the control steps of one epoch, recorded for the runs that turn."""
        step, turns = self.step / self.substeps, state.turning
        angles, rate_b, memory = state.angles, state.rate_b, state.memory
        reference = self.track.rate_o[:, epoch] * self.turning_axes
        points = between(self.track, epoch, self.step, self.substeps)
        if compiled.available():
            given = points, factors, reference, state, self._constants, tuple(result[3:])
            return turning.turned((epoch, step), *given)
        for j, factor in enumerate(np.moveaxis(factors, 1, 0)):
            shown = self.camera.shown(points[j], angles)
            measured = angles * factor[..., :3], rate_b * factor[..., 3:]
            torque, memory = two_stage.advance(
                self.controller, memory, self.camera.measured(shown), *measured, step
            )
            for history, now in zip(result[3:], (memory.stage, shown[0], torque, rate_b)):
                history[turns, epoch, j] = now[turns]
            acting = self.delivered * torque
            angles, rate_b = self.plant.move(angles, rate_b, acting, reference, step)
        return state._replace(angles=angles, rate_b=rate_b, memory=memory)

    @cached_property
    def _constants(self) -> turning.Constants:
        runs, _, satellites = self.track.point_o.shape[:3]
        own = self.controller, self.camera, self.plant, self.delivered
        return turning.constants(*own, (runs, satellites))


def _left_behind(angles: Array, turn_o: Array) -> Array:
    """Angles of a body at rest after its reference axes have turned by ``turn_o (..., 3)``, rad."""
    back = quaternion.to_matrix(quaternion.exp(-turn_o))
    return euler.from_matrix(back @ euler.to_matrix(angles))


def _empty(runs: int, epochs: int, substeps: int, satellites: int) -> Pointing:
    fine = (runs, epochs, substeps, satellites)
    return Pointing(
        np.zeros((runs, epochs), dtype=np.int64),
        np.full((runs, epochs, satellites, 3), np.nan),
        np.full((runs, epochs, satellites, 2), np.nan),
        *(np.full(shape, np.nan) for shape in (fine, (*fine, 2), (*fine, 3), (*fine, 3))),
    )
