"""What two cameras show of a point as plain loops over one run, for `debrisest.compiled`.

Equations are those of `sensors/stereo.py`, where their words are.
"""

from debrisest.arrays import Array, IntArray
from debrisest.attitude.vector_loops import Vector, applied, cross
from debrisest.compiled import compiled


@compiled
def add_row(by: Array, scale: float, left: float, flows: bool, square: Array, pull: Array) -> None:
    """Add a row's squares above the diagonal; one that does not flow depends on the place alone."""
    for a in range(6 if flows else 3):
        scaled = by[a] * scale
        pull[a] += scaled * left
        for b in range(a, 6 if flows else 3):
            square[a, b] += scaled * (by[b] * scale)


@compiled
def rows_of_point(
    state: Array,
    arm: Vector,
    camera: tuple[Array, float],
    rows: IntArray,
    shown: Array,
    by: Array,
) -> None:
    """Write what a point shows (r,), and its derivative (r, 6) by its place and velocity."""
    axes, baseline = camera
    moved = cross((state[6], state[7], state[8]), arm)
    point = applied(axes, (state[0] + arm[0], state[1] + arm[1], state[2] + arm[2]))
    velocity = applied(axes, (state[3] + moved[0], state[4] + moved[1], state[5] + moved[2]))
    near = 1.0 / point[1]
    recede = velocity[1] * near
    for i in range(len(rows)):
        row, across = rows[i], 2 * (rows[i] % 2)
        slope = (point[across] - (baseline if row % 4 == 2 else 0.0)) * near
        side, ahead = near, -slope * near
        if row < 4:
            shown[i] = slope
        elif row < 8:
            shown[i] = (velocity[across] - slope * velocity[1]) * near
            by[i, 3], by[i, 4], by[i, 5] = _row(axes, across, near, -slope * near)
            side, ahead = -recede * near, (slope * recede - shown[i]) * near
        else:
            shown[i], side, ahead = -baseline * near, 0.0, baseline * near * near
        by[i, 0], by[i, 1], by[i, 2] = _row(axes, across, side, ahead)


@compiled
def _row(axes: Array, across: int, side: float, ahead: float) -> Vector:
    """A vector in the leader's axes, of its components across and ahead in a camera's."""
    return (
        side * axes[across, 0] + ahead * axes[1, 0],
        side * axes[across, 1] + ahead * axes[1, 1],
        side * axes[across, 2] + ahead * axes[1, 2],
    )
