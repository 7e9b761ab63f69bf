"""The two laws of the pointing control for one satellite, for `debrisest.compiled`.

The formulas are those of `pixel_tracking`, `attitude_hold`, `robust_term` and `rigid_spacecraft`.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.euler_loops import Vector, body_rate, into_body, rates, rates_change
from debrisest.compiled import compiled
from debrisest.control.pixel_tracking import NEAR
from debrisest.linear_algebra_loops import solve

Craft = tuple[Array, Array]
"""Inertia (3, 3) and gyroscopic matrix (9, 3)."""
Gains = tuple[Array, Array, Array, Array]
"""Proportional, damping, robustness, boundary."""
Robust = tuple[int, float, float]
"""Which reading, by its place among all of them, F and D."""

Scratch = tuple[Array, Array, Array, Array, Array]
"""Three of (5,), growth of the integral first; a matrix (2, 3) and one (3, 3)."""


@compiled
def acceleration(gyroscopic: Array, rate_b: Vector) -> Vector:
    """Return the angular acceleration without a torque."""
    x = y = z = 0.0
    for i in range(3):
        for j in range(3):
            product = rate_b[i] * rate_b[j]
            x += product * gyroscopic[3 * i + j, 0]
            y += product * gyroscopic[3 * i + j, 1]
            z += product * gyroscopic[3 * i + j, 2]
    return x, y, z


@compiled
def turned(matrix: Array, vector: Vector) -> Vector:
    """Return the matrix (3, 3) times the vector."""
    x, y, z = vector
    return (
        matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z,
        matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z,
        matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z,
    )


@compiled
def robust_term(
    robust: Robust, feedback: float, drift: float, surface: float, eta: float, boundary: float
) -> float:
    """Return one component of k s."""
    reading, of_drift, of_gain = robust
    if reading == 4:
        return 0.0
    bound, share = of_drift * abs(drift), 1.0 - of_gain
    if reading < 2:
        return (bound + of_gain * feedback + eta * surface) / share
    largest = bound + of_gain * abs(feedback) + eta * abs(surface)
    if reading == 3:
        return float(np.sign(surface) * largest / share)
    return min(max(surface / boundary, -1.0), 1.0) * largest / share


@compiled
def track_pixel(
    craft: Craft,
    gains: Gains,
    robust: Robust,
    of_pixel: tuple[Array, Array],
    rate_b: Vector,
    integral: Array,
    scale: float,
    scratch: Scratch,
) -> Vector:
    """Return the torque of the first stage, and write how its integral (5,) grows.

    ``of_pixel`` is where it was seen, and where it is to be.
    """
    proportional, damping, robustness, boundary = gains
    (pixel, desired), (growth, wanted, drift, matrix, _) = of_pixel, scratch
    x, y = pixel[0] / scale, pixel[1] / scale
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = scale * x * y, -scale * y, -scale * (1.0 + x * x)
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = scale * (1.0 + y * y), scale * x, -scale * x * y
    wx, wy, wz = rate_b[0], rate_b[2], -rate_b[1]
    free = acceleration(craft[1], rate_b)
    moving_x, moving_y = _dot(matrix[0], rate_b), _dot(matrix[1], rate_b)
    product = moving_x * y + x * moving_y
    drift[0] = product * wx - 2.0 * x * moving_x * wy + moving_y * wz + _dot(matrix[0], free)
    drift[1] = 2.0 * y * moving_y * wx - product * wy - moving_x * wz + _dot(matrix[1], free)
    for a in range(5):
        error = desired[a] - pixel[a] if a < 2 else -rate_b[a - 2]
        feedback, surface = proportional[a] * error, proportional[a] * integral[a]
        if a < 2:
            moving = moving_x if a == 0 else moving_y
            feedback -= damping[a] * moving
            surface += damping[a] * error - moving
        else:
            drift[a] = free[a - 2]
            surface += error
        feedback -= drift[a]
        push = robust_term(robust, feedback, drift[a], surface, robustness[a], boundary[a])
        wanted[a], growth[a] = feedback + push, error
    if robust[0] == 1 and not (abs(growth[0]) < NEAR and abs(growth[1]) < NEAR):
        growth[:] = 0.0
    return turned(craft[0], _least_squares(scratch))


@compiled
def _dot(row: Array, vector: Vector) -> float:
    return float(row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])


@compiled
def _least_squares(scratch: Scratch) -> Vector:
    """Return the angular acceleration nearest to what is wanted."""
    _, wanted, right, matrix, normal = scratch
    for i in range(3):
        right[i] = matrix[0, i] * wanted[0] + matrix[1, i] * wanted[1] + wanted[2 + i]
        for j in range(3):
            normal[i, j] = matrix[0, i] * matrix[0, j] + matrix[1, i] * matrix[1, j]
        normal[i, i] += 1.0
    solve(normal, right[:3])
    return right[0], right[1], right[2]


@compiled
def hold_attitude(
    craft: Craft,
    gains: Gains,
    robust: Robust,
    desired: Array,
    measured: tuple[Vector, Vector],
    integral: Array,
    scratch: Scratch,
) -> Vector:
    """Return the torque of the second stage, and write how its integral (3,) grows."""
    (angles, rate_b), (growth, wanted, _, _, _) = measured, scratch
    proportional, damping, robustness, boundary = gains
    bent = rates_change(angles, rate_b)
    free = rates(angles, acceleration(craft[1], rate_b))
    moving = rates(angles, rate_b)
    for a in range(3):
        drift, error = bent[a] + free[a], desired[a] - angles[a]
        feedback = proportional[a] * error - damping[a] * moving[a] - drift
        surface = proportional[a] * integral[a] + damping[a] * error - moving[a]
        push = robust_term(robust, feedback, drift, surface, robustness[a], boundary[a])
        wanted[a], growth[a] = feedback + push, error
    return turned(craft[0], body_rate(angles, (wanted[0], wanted[1], wanted[2])))


@compiled
def move(
    gyroscopic: Array, pushed: Vector, angles: Vector, rate_b: Vector, reference: Array, step: float
) -> tuple[Vector, Vector]:
    """Return angles and body rate a step later, as `Spacecraft.move`."""
    a, w = angles, rate_b
    angle_sum, rate_sum = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    turning = reference[0] != 0.0 or reference[1] != 0.0 or reference[2] != 0.0
    for i in range(4):
        reach = 0.5 * step if i < 2 else step
        weight = step / 6.0 * (2.0 if i == 1 or i == 2 else 1.0)
        seen = w
        if turning:
            x, y, z = into_body(a, reference)
            seen = w[0] - x, w[1] - y, w[2] - z
        slope, free = rates(a, seen), acceleration(gyroscopic, w)
        faster = pushed[0] + free[0], pushed[1] + free[1], pushed[2] + free[2]
        angle_sum, rate_sum = _plus(angle_sum, weight, slope), _plus(rate_sum, weight, faster)
        a, w = _plus(angles, reach, slope), _plus(rate_b, reach, faster)
    return _plus(angles, 1.0, angle_sum), _plus(rate_b, 1.0, rate_sum)


@compiled
def _plus(vector: Vector, factor: float, other: Vector) -> Vector:
    return (
        vector[0] + factor * other[0],
        vector[1] + factor * other[1],
        vector[2] + factor * other[2],
    )
