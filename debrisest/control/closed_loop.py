"""The closed loop of several satellites: measure until the target nears an image's edge, then turn.

Estimation sections advance by the scenario's step and hold the attitude; as soon as the target is
within a margin of the edge of any satellite's image, or has left it, all satellites turn, in
control steps, until the slowest is done (Li et al., section V). The next estimation section starts
at the first epoch after that and lasts at least one epoch.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.attitude import euler, quaternion
from debrisest.control import two_stage
from debrisest.control.rigid_spacecraft import Spacecraft, reference_rate_b
from debrisest.control.track import Track, between
from debrisest.control.two_stage import Controller, Memory
from debrisest.sensors import pinhole

Frozen = Literal["local", "inertial"]
"""Axes in which the attitude stands still between the control sections."""

Factors = Callable[[], Array]
"""What the measured angles and rates of an epoch are multiplied by, (run, substep, satellite, 6);
called once an epoch, in order."""


class Camera(NamedTuple):
    """The image, and what the controller is given of it."""

    half_size: Array
    """(run, 1, 2), pixels."""
    margin: float = 2.5
    rounded: bool = True


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


class _State(NamedTuple):
    """Of all satellites in all runs, at an epoch."""

    section: IntArray
    angles: Array
    rate_b: Array
    seen: Array
    """Last pixel in view in this section, as measured; NaN where there is none."""
    memory: Memory


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

    def run(self, angles0: Array) -> Pointing:
        """Return what happens from the angles ``angles0 (run, satellite, 3)`` on.

        A controller that makes the spacecraft tumble ends in pixels out of view or in NaN.
        """
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self._run(angles0)

    def _run(self, angles0: Array) -> Pointing:
        runs, epochs = self.track.point_o.shape[:2]
        result = _empty(runs, epochs, self.substeps, angles0.shape[1])
        seen = self._measured(self._shown(self.track.point_o[:, 0], angles0))
        section, memory = np.zeros(runs, dtype=np.int64), two_stage.start(seen, angles0)
        state = _State(section, angles0, np.zeros_like(angles0), seen, memory)
        for epoch in range(epochs):
            factors = self.factors()
            if epoch > 0:
                state = self._scheduled(epoch, state, factors[:, 0])
            result.section[:, epoch], result.angles[:, epoch] = state.section, state.angles
            pixel, visible = self._shown(self.track.point_o[:, epoch], state.angles)
            result.pixel[:, epoch] = np.where(visible[..., None], pixel, np.nan)
            if epoch + 1 < epochs:
                state = self._advanced(epoch, state, factors, result)
        return result

    def in_view(self, angles: Array) -> BoolArray:
        """Where (run, satellite) the target is in view at the first epoch."""
        return self._shown(self.track.point_o[:, 0], angles)[1]

    def _shown(self, point_o: Array, angles: Array) -> tuple[Array, BoolArray]:
        """Pixel (run, satellite, 2) of the target, and where it is in view."""
        return _shown(self.controller.scale, self.camera.half_size, point_o, angles)

    def _measured(self, shown: tuple[Array, BoolArray]) -> Array:
        pixel, visible = shown
        pixel = np.rint(pixel) if self.camera.rounded else pixel
        return np.where(visible[..., None], pixel, np.nan)

    def _scheduled(self, epoch: int, state: _State, factors: Array) -> _State:
        """The state after sections that end at this epoch have ended, and others have started."""
        pixel = self._measured(self._shown(self.track.point_o[:, epoch], state.angles))
        turning = state.section % 2 == 1
        ends = turning & (state.memory.stage == two_stage.DONE).all(-1)
        starts = ~turning & self._nears_edge(pixel, state.seen)
        new = np.isnan(pixel) & ~ends[:, None, None]
        state = state._replace(section=state.section + ends + starts)
        state = state._replace(seen=np.where(new, state.seen, pixel))
        if not starts.any():
            return state
        fresh = two_stage.start(state.seen, state.angles * factors[..., :3])
        memory = _chosen(starts, fresh, state.memory)
        rate_b = _where(starts, self._rate_at_rest(epoch, state.angles), state.rate_b)
        return state._replace(memory=memory, rate_b=rate_b)

    def _nears_edge(self, pixel: Array, seen: Array) -> BoolArray:
        """Runs in which a satellite that saw the target sees it at the edge or not at all."""
        inside = (np.abs(pixel) < self.camera.half_size - self.camera.margin).all(-1)
        return np.asarray((~np.isnan(seen).any(-1) & ~inside).any(-1))

    def _rate_at_rest(self, epoch: int, angles: Array) -> Array:
        """Body rate of a satellite whose attitude stood still."""
        if not self.turning_axes or self.frozen == "inertial":
            return np.zeros_like(angles)
        return reference_rate_b(angles, self.track.rate_o[:, epoch])

    def _advanced(self, epoch: int, state: _State, factors: Array, result: Pointing) -> _State:
        """The state at the next epoch."""
        waiting = state.angles
        if self.frozen == "inertial":
            waiting = _left_behind(waiting, self.track.rate_o[:, epoch] * self.step)
        turning = state.section % 2 == 1
        if not turning.any():
            return state._replace(angles=waiting)
        after = self._turned(epoch, state, factors, turning, result)
        return state._replace(
            angles=_where(turning, after.angles, waiting),
            rate_b=_where(turning, after.rate_b, state.rate_b),
            memory=_chosen(turning, after.memory, state.memory),
        )

    def _turned(
        self, epoch: int, state: _State, factors: Array, turning: BoolArray, result: Pointing
    ) -> _State:
        """The state after the control steps of one epoch, recorded for the runs that turn."""
        step = self.step / self.substeps
        angles, rate_b, memory = state.angles, state.rate_b, state.memory
        reference = self.track.rate_o[:, epoch] * self.turning_axes
        points = between(self.track, epoch, self.step, self.substeps)
        for j, factor in enumerate(np.moveaxis(factors, 1, 0)):
            shown = self._shown(points[j], angles)
            measured = angles * factor[..., :3], rate_b * factor[..., 3:]
            torque, memory = two_stage.advance(
                self.controller, memory, self._measured(shown), *measured, step
            )
            for history, now in zip(result[3:], (memory.stage, shown[0], torque, rate_b)):
                history[turning, epoch, j] = now[turning]
            angles, rate_b = self.plant.move(angles, rate_b, torque, reference, step)
        return state._replace(angles=angles, rate_b=rate_b, memory=memory)


def _shown(
    scale: Array, half_size: Array, point_o: Array, angles: Array
) -> tuple[Array, BoolArray]:
    point_b = (point_o[..., None, :] @ euler.to_matrix(angles))[..., 0, :]
    point_c = point_b @ pinhole.BODY_TO_CAMERA.T
    pixel = pinhole.project(point_c, scale)
    return pixel, pinhole.in_view(point_c, pixel, half_size)


def _left_behind(angles: Array, turn_o: Array) -> Array:
    """Angles of a body at rest after its reference axes have turned by ``turn_o (..., 3)``, rad."""
    back = quaternion.to_matrix(quaternion.exp(-turn_o))
    return euler.from_matrix(back @ euler.to_matrix(angles))


def _where(runs: BoolArray, new: Array, old: Array) -> Array:
    return np.where(runs.reshape(-1, *[1] * (new.ndim - 1)), new, old)


def _chosen(runs: BoolArray, new: Memory, old: Memory) -> Memory:
    stage = np.where(runs[:, None], new.stage, old.stage)
    return Memory(stage, *(_where(runs, a, b) for a, b in zip(new[1:], old[1:])))


def _empty(runs: int, epochs: int, substeps: int, satellites: int) -> Pointing:
    fine = (runs, epochs, substeps, satellites)
    return Pointing(
        np.zeros((runs, epochs), dtype=np.int64),
        np.full((runs, epochs, satellites, 3), np.nan),
        np.full((runs, epochs, satellites, 2), np.nan),
        *(np.full(shape, np.nan) for shape in (fine, (*fine, 2), (*fine, 3), (*fine, 3))),
    )
