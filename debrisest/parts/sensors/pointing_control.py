"""Satellites that turn their cameras after a piece of debris before it leaves the image."""

from functools import lru_cache
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data
from debrisest.attitude import euler, quaternion
from debrisest.clock import Clock
from debrisest.control.camera import Camera
from debrisest.control.closed_loop import ClosedLoop, Factors, Frozen
from debrisest.control.rigid_spacecraft import Spacecraft, scaled, spacecraft
from debrisest.control.robust_term import Reading, Uncertainty
from debrisest.control.track import seen_from
from debrisest.control.two_stage import Controller
from debrisest.draws import Draws, Stream
from debrisest.dynamics.local_frame import Axes, local_axes
from debrisest.parts.sensors.pointing_checks import (
    control_steps,
    require_known,
    require_room,
    require_view,
)
from debrisest.parts.sensors.pointing_keys import (
    Holding,
    OwnSatellite,
    Switching,
    Tensor,
    Tracking,
    gains,
    switch,
)
from debrisest.parts.sensors.pointing_results import epochs, history, mismatches, scalars
from debrisest.roles import NonNegative, Positive, SimulationPart
from debrisest.sensors.pinhole import BODY_TO_CAMERA
from debrisest.vocabulary import has_runs

_INPUTS = (
    *("orbit_position", "orbit_velocity", "observer_position", "observer_velocity"),
    *("focal_px", "image_half_size"),
)

_UNCERTAINTY = Uncertainty()


class PointingControl(SimulationPart):
    """The closed loop of camera, controller and spacecraft, alike on all satellites.

    The controller sees the debris' own pixel and never an estimate.
    """

    version = 3
    tried = True
    needs = (*_INPUTS, "observer")
    truths = (
        *("true_q_ic", "true_euler", "true_pixel", "cameras_at_start", "pointing_status"),
        *("control_pixel", "first_section", "settling_time", "stage_one_time"),
        *("peak_torque", "total_variation", "final_angle", "drift_mismatch", "gain_mismatch"),
    )
    knows = ("section", "control_time_s", "torque")
    kind: Literal["pointing_control"]
    inertia_kg_m2: Tensor
    """Inertia tensor, body axes."""
    satellites: dict[str, OwnSatellite] = {}
    """What a satellite has of its own, by observer."""
    inertia_error: NonNegative = 0.0
    """Standard deviation of the logarithm of the real second moments of mass over the model's,
    along each axis, drawn for each run and satellite."""
    torque_error: NonNegative = 0.0
    """Standard deviation of the logarithm of the share of each torque component that acts, drawn
    likewise."""
    axes: Axes = "repaired"
    """Local orbital axes: transverse, orbit normal, radial; or radial, transverse, normal, with
    which the debris of Li et al. is behind the cameras: then there is no control, and
    `pointing_status`, which tells of whole epochs, says so."""
    robust_term: Reading = "literal"
    """Reading of the law's robust term: as printed; the same with an integral that, in the first
    stage, grows only near the goal; with the sign of the sliding surface and a linear stretch;
    without that stretch, which chatters; feedback linearisation alone."""
    margin_px: NonNegative = 2.5
    """How near to an edge the debris may come."""
    control_step_s: Positive = 0.02
    """Control step, at most; `step_s` has a whole number of them, 1 to 10000."""
    torque_limit_n_m: Positive | None = None
    """Largest torque about each axis."""
    anti_windup: bool = True
    """Integrals stand still while the torque is at its limit."""
    angle_error: NonNegative = 0.05
    """Share by which measured Euler angles are wrong."""
    rate_error: NonNegative = 0.05
    """Share by which measured rates are wrong."""
    errors: Literal["constant", "white"] = "constant"
    """Kind of these errors: the same share always, or a standard deviation, drawn at each control
    step."""
    whole_pixels: bool = True
    """The controller sees whole pixels."""
    orbital_rate: Literal["ignored", "counted"] = "ignored"
    """Whether the local axes' turning moves the spacecraft in them."""
    held_in: Frozen = "local"
    """Axes in which the attitude stands still in estimation sections."""
    drift_error: NonNegative = _UNCERTAINTY.drift
    """Share of the state function that the robust term covers."""
    gain_error: Annotated[float, Field(ge=0, lt=1)] = _UNCERTAINTY.gain
    """Share of the input matrix that it covers."""
    tracking: Tracking = Tracking()
    """Gains of the first stage, for two pixels and three rates."""
    holding: Holding = Holding()
    """Gains of the second stage, for three angles."""
    desired_px: Annotated[list[float], Field(min_length=2, max_length=2)] = [0.0, 0.0]
    """Pixel that the debris is brought to, from the middle."""
    switching: Switching = Switching()
    """When one stage changes to the next."""
    store_every: Annotated[int, Field(ge=1)] = 25
    """Control steps from one stored torque to the next."""

    @property
    def _drawn(self) -> bool:
        """Whether each run has errors of its own."""
        return bool(self.errors == "white" or self.inertia_error or self.torque_error)

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return attitude, sections, exact pixels, and what the controller did.

        Where all runs are alike, which is usual, one is simulated for all of them.
        """
        inputs = [np.asarray(data[name], dtype=np.float64) for name in _INPUTS]
        names = tuple(str(name) for name in data["observer"])
        require_known(self.satellites, names)
        if self._drawn or any((x != x[:1]).any() for x in inputs):
            return _simulated(self, names, inputs, clock, draws)
        packed = ((x.shape[1:], x[0].tobytes()) for x in inputs)
        times, runs = clock.times.tobytes(), len(draws.runs)
        one = _simulated_once(self.model_dump_json(), names, times, *packed)
        return {
            name: np.repeat(value, runs, axis=0) if has_runs(name) else value.copy()
            for name, value in one.items()
        }


@lru_cache(maxsize=4)
def _simulated_once(
    part: str, names: tuple[str, ...], times: bytes, *inputs: tuple[tuple[int, ...], bytes]
) -> Data:
    """The same for all chunks of runs that have the same inputs."""
    arrays = [np.frombuffer(values).reshape(1, *shape) for shape, values in inputs]
    clock = Clock(np.frombuffer(times))
    return _simulated(PointingControl.model_validate_json(part), names, arrays, clock, None)


def _simulated(
    part: PointingControl,
    names: tuple[str, ...],
    inputs: list[Array],
    clock: Clock,
    draws: Draws | None,
) -> Data:
    observers = inputs[2], inputs[3]
    require_room(part.margin_px, inputs[5])
    loop = _loop(part, names, inputs, clock, draws)
    starts = [np.radians(own.angles_deg) for own in _own(part, names)]
    angles = np.zeros(loop.track.point_o[:, 0].shape) + starts
    visible = loop.in_view(angles)
    if part.axes == "repaired":
        require_view(visible)
    happened = loop.run(angles)
    q_io = quaternion.from_matrix(local_axes(*observers, part.axes))
    q_ib = quaternion.multiply(q_io, euler.to_quaternion(happened.angles))
    q_bc = quaternion.from_matrix(BODY_TO_CAMERA.T)
    return {
        "true_q_ic": quaternion.multiply(q_ib, q_bc),
        "cameras_at_start": visible.sum(-1).astype(np.float64),
        **epochs(happened),
        **history(happened, clock, part.store_every),
        **scalars(happened, clock, loop.controller.desired),
        **mismatches(happened, loop),
    }


def _own(part: PointingControl, names: tuple[str, ...]) -> list[OwnSatellite]:
    return [part.satellites.get(name, OwnSatellite()) for name in names]


def _loop(
    part: PointingControl,
    names: tuple[str, ...],
    inputs: list[Array],
    clock: Clock,
    draws: Draws | None,
) -> ClosedLoop:
    position, velocity, observer_position, observer_velocity, scale, half_size = inputs
    track = seen_from(position, velocity, observer_position, observer_velocity, part.axes)
    own = (satellite.inertia_kg_m2 or part.inertia_kg_m2 for satellite in _own(part, names))
    craft = spacecraft(np.array(list(own)))
    plant, delivered = _plant(part, craft, len(scale), draws)
    camera = Camera(scale[:, None], half_size[:, None], part.margin_px, part.whole_pixels)
    controller = Controller(
        craft=craft,
        scale=camera.scale,
        reading=part.robust_term,
        tracking=gains(part.tracking),
        holding=gains(part.holding),
        uncertainty=Uncertainty(part.drift_error, part.gain_error),
        switch=switch(part.switching),
        torque_limit=np.inf if part.torque_limit_n_m is None else part.torque_limit_n_m,
        anti_windup=part.anti_windup,
        desired=np.array(part.desired_px),
    )
    substeps = control_steps(clock.step, part.control_step_s)
    return ClosedLoop(
        controller=controller,
        camera=camera,
        plant=plant,
        track=track,
        step=clock.step,
        substeps=substeps,
        factors=_factors(part, (substeps, observer_position.shape[2], 6), len(scale), draws),
        turning_axes=part.orbital_rate == "counted",
        frozen=part.held_in,
        delivered=delivered,
    )


def _plant(
    part: PointingControl, craft: Spacecraft, runs: int, draws: Draws | None
) -> tuple[Spacecraft, Array | float]:
    """The satellites as they really are, and the share of each torque that acts."""
    if draws is None:
        return craft, 1.0
    shape = (2, len(craft.inertia), 3)
    mass, torque = np.moveaxis(draws.normal(Stream.TRUTH, shape), 1, 0)
    inertia = scaled(craft.inertia, np.exp(part.inertia_error * mass))
    return spacecraft(inertia), np.exp(part.torque_error * torque)


def _factors(
    part: PointingControl, shape: tuple[int, ...], runs: int, draws: Draws | None
) -> Factors:
    """What multiplies measured angles and rates: the same always, or new at every control step."""
    shares = np.repeat([part.angle_error, part.rate_error], 3)
    constant = np.broadcast_to(1.0 + shares, (runs, *shape))
    if draws is None or part.errors == "constant":
        return lambda: constant
    return lambda: 1.0 + shares * draws.normal(Stream.MEASUREMENT_NOISE, shape)
