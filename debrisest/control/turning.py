"""Turns of satellites through the control steps of an epoch, by compiled loops."""

from typing import Any, NamedTuple, get_args

import numpy as np

from debrisest.arrays import Array
from debrisest.control.camera import Camera
from debrisest.control.rigid_spacecraft import Spacecraft
from debrisest.control.robust_term import Reading
from debrisest.control.schedule import State
from debrisest.control.two_stage import Controller, Memory


class Constants(NamedTuple):
    """What does not change from epoch to epoch, as `turning_loops` has it."""

    bodies: Any
    camera: Any
    law: Any
    switch: Any


def constants(
    controller: Controller,
    camera: Camera,
    plant: Spacecraft,
    delivered: Array | float,
    shape: tuple[int, int],
) -> Constants:
    """Return the constants of so many runs and satellites."""
    law, believed, runs = controller, controller.craft, shape[0]

    def each(values: Array | float, *axes: int) -> Array:
        return np.array(np.broadcast_to(values, axes))

    robust = get_args(Reading).index(law.reading), *map(float, law.uncertainty)
    limit = each(np.reshape(law.torque_limit, -1), runs)
    scale, half_size = each(camera.scale[:, 0], runs), each(camera.half_size[:, 0], runs, 2)
    return Constants(
        bodies=(
            *(each(believed.inertia, *shape, 3, 3), each(believed.gyroscopic, *shape, 9, 3)),
            *(each(plant.inverse, *shape, 3, 3), each(plant.gyroscopic, *shape, 9, 3)),
            each(delivered, *shape, 3),
        ),
        camera=(scale, half_size, camera.rounded),
        law=(tuple(law.tracking), tuple(law.holding), robust, law.desired, limit, law.anti_windup),
        switch=tuple(map(float, law.switch)),
    )


def turned(
    at: tuple[int, float],
    points: Array,
    factors: Array,
    reference: Array,
    state: State,
    constants: Constants,
    history: tuple[Array, ...],
) -> State:
    """Return the state after the control steps of an epoch, the same where nothing turns.

    ``at`` is the epoch and the control step, s; the other arguments are as in `turning_loops`.
    """
    from debrisest.control import turning_loops

    copies: Any = (part.copy() for part in state.memory)
    angles, rate_b, memory = state.angles.copy(), state.rate_b.copy(), Memory(*copies)
    seen = (np.ascontiguousarray(part) for part in (points, factors, reference))
    given: Any = *seen, (angles, rate_b), tuple(memory), *constants, history
    turning_loops.turn((*at, state.turning), *given)
    return state._replace(angles=angles, rate_b=rate_b, memory=memory)
