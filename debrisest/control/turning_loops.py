"""The control steps of an epoch as plain loops over satellites, for `debrisest.compiled`.

What the camera shows, when the stages change and what the torques do: the formulas are those of
`closed_loop`, `camera` and `two_stage`.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.attitude.euler_loops import Vector, into_body
from debrisest.compiled import compiled
from debrisest.control.law_loops import (
    Gains,
    Robust,
    Scratch,
    hold_attitude,
    move,
    track_pixel,
    turned,
)
from debrisest.control.two_stage import HOLDING, TRACKING

Memory = tuple[IntArray, Array, Array, Array, Array, Array, Array]
"""As `two_stage.Memory`, of all satellites or of one."""
Bodies = tuple[Array, Array, Array, Array, Array]
"""Inertia and gyroscopic matrix that are believed; inverse inertia and gyroscopic matrix as they
are, and the share of a torque that acts, all (run, satellite, ...)."""
Camera = tuple[Array, Array, bool]
"""Focal length (run,) and half size (run, 2), px, and whether pixels are rounded."""
Law = tuple[Gains, Gains, Robust, Array, Array, bool]
"""Gains of both stages, the robust term, the desired pixel (2,), the limits of torques (run,), and
whether integrals stand still at the limit."""
Switch = tuple[float, float, float, float, float, float]
"""As `two_stage.Switch`."""


@compiled
def turn(
    at: tuple[int, float, BoolArray],
    points: Array,
    factors: Array,
    reference: Array,
    motion: tuple[Array, Array],
    memory: Memory,
    bodies: Bodies,
    camera: Camera,
    law: Law,
    switch: Switch,
    history: tuple[Array, Array, Array, Array],
) -> None:
    """Take the control steps of an epoch; change ``motion`` and ``memory`` in place.

    ``at`` is the epoch, the control step, s, and the runs (run,) that turn; ``points (substep, run,
    satellite, 3)``, ``factors (run, substep, satellite, 6)``, ``reference (run, satellite, 3)``;
    ``motion`` are angles and rates (run, satellite, 3). The ``history`` of stages, pixels, torques
    and rates is (run, time, substep, satellite, ...).
    """
    epoch, step, turning = at
    stage, pixels, torques, rates = history
    scratch = np.empty(5), np.empty(5), np.empty(5), np.empty((2, 3)), np.empty((3, 3))
    for r in range(len(turning)):
        for s in range(reference.shape[1] if turning[r] else 0):
            inverse, free, share = bodies[2][r, s], bodies[3][r, s], bodies[4][r, s]
            angles, rate_b = _vector(motion[0][r, s]), _vector(motion[1][r, s])
            own = _own(memory, r, s)
            for j in range(len(points)):
                torque = torques[r, epoch, j, s]
                rates[r, epoch, j, s, :] = rate_b
                _see(camera, r, points[j, r, s], angles, pixels[r, epoch, j, s], own[3])
                measured = _measured(factors[r, j, s], angles, rate_b)
                _switch(switch, law[3], own, measured, step)
                craft, scale = (bodies[0][r, s], bodies[1][r, s]), camera[0][r]
                _demand(craft, law, own, measured, (scale, law[4][r], step), scratch, torque)
                _wait(switch, own, step)
                stage[r, epoch, j, s] = own[0][0]
                acting = torque[0] * share[0], torque[1] * share[1], torque[2] * share[2]
                pushed = turned(inverse, acting)
                angles, rate_b = move(free, pushed, angles, rate_b, reference[r, s], step)
            motion[0][r, s, :], motion[1][r, s, :] = angles, rate_b


@compiled
def _demand(
    craft: tuple[Array, Array],
    law: Law,
    own: Memory,
    measured: tuple[Vector, Vector],
    numbers: tuple[float, float, float],
    scratch: Scratch,
    torque: Array,
) -> None:
    """Write the torque (3,), and let the integral of its stage grow.

    The ``numbers`` are focal length, limit of the torque and step.
    """
    scale, limit, step = numbers
    integral = own[4] if own[0][0] == TRACKING else own[5]
    if own[0][0] == TRACKING:
        of_pixel = own[3], law[3]
        wanted = track_pixel(craft, law[0], law[2], of_pixel, measured[1], integral, scale, scratch)
    else:
        wanted = hold_attitude(craft, law[1], law[2], own[6], measured, integral, scratch)
    if _limited(wanted, limit, torque) or not law[5]:
        for a in range(len(integral)):
            integral[a] += step * scratch[0][a]


@compiled
def _own(memory: Memory, r: int, s: int) -> Memory:
    """Memory of one satellite, numbers as arrays (1,)."""
    stage, elapsed, calm, seen, tracking, holding, desired = memory
    which = slice(s, s + 1)
    return (
        *(stage[r, which], elapsed[r, which], calm[r, which]),
        *(seen[r, s], tracking[r, s], holding[r, s], desired[r, s]),
    )


@compiled
def _vector(values: Array) -> Vector:
    return values[0], values[1], values[2]


@compiled
def _measured(factors: Array, angles: Vector, rate_b: Vector) -> tuple[Vector, Vector]:
    return (
        (angles[0] * factors[0], angles[1] * factors[1], angles[2] * factors[2]),
        (rate_b[0] * factors[3], rate_b[1] * factors[4], rate_b[2] * factors[5]),
    )


@compiled
def _see(camera: Camera, r: int, point: Array, angles: Vector, pixel: Array, seen: Array) -> None:
    """Write the pixel (2,), and the one that was seen last as it is measured."""
    scale, half, rounded = camera
    x, depth, y = into_body(angles, point)
    depth, y = -depth, y
    if depth == 0.0:
        pixel[:] = np.nan
    else:
        pixel[0], pixel[1] = scale[r] * (x / depth), scale[r] * (y / depth)
    if depth > 0.0 and abs(pixel[0]) <= half[r, 0] and abs(pixel[1]) <= half[r, 1]:
        for a in range(2):
            seen[a] = np.rint(pixel[a]) if rounded else pixel[a]


@compiled
def _switch(
    switch: Switch, desired: Array, own: Memory, measured: tuple[Vector, Vector], step: float
) -> None:
    """End tracking where its work is done."""
    angles, rate_b = measured
    pixel, rate, calm, least, most, _ = switch
    small = abs(own[3][0] - desired[0]) <= pixel and abs(own[3][1] - desired[1]) <= pixel
    for a in range(3):
        small = small and abs(rate_b[a]) <= rate
    own[2][0] = own[2][0] + step if small else 0.0
    at_rest = own[1][0] > least - 0.5 * step and own[2][0] > calm - 0.5 * step
    if own[0][0] == TRACKING and (at_rest or own[1][0] > most - 0.5 * step):
        own[0][0] += 1
        own[1][0] = 0.0
        own[6][:] = angles


@compiled
def _limited(wanted: Vector, limit: float, torque: Array) -> bool:
    """Write the torque (3,) that can be had, and return whether it is the wanted one."""
    whole = True
    for a in range(3):
        torque[a] = limit if wanted[a] > limit else -limit if wanted[a] < -limit else wanted[a]
        whole = whole and torque[a] == wanted[a]
    return whole


@compiled
def _wait(switch: Switch, own: Memory, step: float) -> None:
    """End holding where it has lasted long enough."""
    own[1][0] += step
    if own[0][0] == HOLDING and own[1][0] > switch[5] - 0.5 * step:
        own[0][0] += 1
