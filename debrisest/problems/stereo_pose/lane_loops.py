"""Points before two cameras over some epochs at a time, which lie side by side in memory.

A number of every epoch is one of `LANES` in an array, whose place the compiler knows, so that it
makes vectors of a loop over them. Equations are those of `sensors/stereo.py` and
`replay.point_rows`; vectors are in the cameras' axes. What arrays hold, each number so many lanes:

* ``body``: position, velocity, rate, and the target's axes, one after the other (18);
* ``view``: near, two slopes across and one up, and derivatives of the flow by the place (8);
* ``square (6, 6)``: what is told of place and velocity together, and what pulls at them, `push`;
* ``by_arm (3, 15)``: what the arm tells together with position, velocity, rate, attitude, itself.
"""

from debrisest.arrays import Array, IntArray
from debrisest.attitude.vector_loops import Vector, cross
from debrisest.compiled import compiled

LANES = 32
_ROWS = 9
_X, _Y, _Z, _U, _V, _W = (LANES * c for c in range(6))
_P, _Q, _R = (LANES * c for c in range(6, 9))
_AXES, _COLUMN = 9 * LANES, 15 * LANES
_NEAR, _RIGHT, _LEFT, _UP, _OFF, _BY_RIGHT, _BY_LEFT, _BY_UP = (LANES * c for c in range(8))


@compiled
def shown_of(
    body: Array, point: Array, baseline: float, width: int, arm: Array, view: Array, shown: Array
) -> None:
    """Write arm (3), view (8) and what is shown (9) of a point (3,) in the body."""
    a, b, c = point[0], point[1], point[2]
    for i in range(3):
        o, e = LANES * i, _AXES + LANES * i
        for k in range(width):
            arm[o + k] = a * body[e + k] + b * body[e + _U + k] + c * body[e + _P + k]
    for k in range(width):
        x, y, z = arm[_X + k], arm[_Y + k], arm[_Z + k]
        p, q, r = body[_P + k], body[_Q + k], body[_R + k]
        u = body[_U + k] + (q * z - r * y)
        v = body[_V + k] + (r * x - p * z)
        w = body[_W + k] + (p * y - q * x)
        near = 1.0 / (body[_Y + k] + y)
        right, up = (body[_X + k] + x) * near, (body[_Z + k] + z) * near
        left, recede = right - baseline * near, v * near
        across, beside, rise = (u - right * v) * near, (u - left * v) * near, (w - up * v) * near
        shown[k], shown[LANES + k], shown[2 * LANES + k], shown[3 * LANES + k] = right, up, left, up
        shown[4 * LANES + k], shown[5 * LANES + k] = across, rise
        shown[6 * LANES + k], shown[7 * LANES + k] = beside, rise
        shown[8 * LANES + k] = -baseline * near
        view[_NEAR + k], view[_RIGHT + k], view[_LEFT + k], view[_UP + k] = near, right, left, up
        view[_OFF + k] = -recede * near
        view[_BY_RIGHT + k] = (right * recede - across) * near
        view[_BY_LEFT + k] = (left * recede - beside) * near
        view[_BY_UP + k] = (up * recede - rise) * near


@compiled
def weighted(
    seen: tuple[Array, Array],
    noise: Array,
    rows: IntArray,
    at: tuple[int, int, int, int],
    shown: Array,
    square: Array,
    pull: Array,
    cost: Array,
) -> None:
    """Write for each row its square over its variance and what pulls; add what they cost.

    ``seen`` is what is measured and weights (epoch, m); ``at`` says where in these: the point, the
    first epoch, how many, and how many lanes.
    """
    measured, weight = seen
    point, first, count, width = at
    for i in range(len(rows)):
        m, o = len(rows) * point + i, LANES * rows[i]
        for k in range(count):
            scale = weight[first + k, m] / noise[m]
            left = measured[first + k, m] - shown[o + k] / noise[m]
            left *= weight[first + k, m]
            square[o + k], pull[o + k] = scale * scale, scale * left
            cost[k] += left * left
        for k in range(count, width):
            square[o + k] = pull[o + k] = 0.0


@compiled
def told_by_rows(
    rows: Array, pulls: Array, view: Array, baseline: float, width: int, square: Array, push: Array
) -> None:
    """Write what rows (9) tell of place and velocity: ``square (6, 6)`` and ``push (6)``."""
    for k in range(width):
        near, off, up, by_up = view[_NEAR + k], view[_OFF + k], view[_UP + k], view[_BY_UP + k]
        right, left, by_right = view[_RIGHT + k], view[_LEFT + k], view[_BY_RIGHT + k]
        by_left, ahead, n2 = view[_BY_LEFT + k], baseline * near * near, near * near
        a, b = rows[k], rows[2 * LANES + k]
        c = rows[LANES + k] + rows[3 * LANES + k]
        d, e = rows[4 * LANES + k], rows[6 * LANES + k]
        f = rows[5 * LANES + k] + rows[7 * LANES + k]
        flow, slope, turn = d + e, d * right + e * left, d * by_right + e * by_left
        of_both = d * by_right * right + e * by_left * left
        square[k] = n2 * (a + b) + off * off * flow
        square[LANES + k] = off * turn - n2 * (a * right + b * left)
        square[2 * LANES + k] = 0.0
        square[3 * LANES + k], square[4 * LANES + k] = off * near * flow, -off * near * slope
        square[5 * LANES + k] = 0.0
        square[7 * LANES + k] = (
            n2 * (a * right * right + b * left * left + c * up * up)
            + rows[8 * LANES + k] * ahead * ahead
            + (d * by_right * by_right + e * by_left * by_left + f * by_up * by_up)
        )
        square[8 * LANES + k] = f * off * by_up - n2 * c * up
        square[9 * LANES + k], square[10 * LANES + k] = (
            near * turn,
            -near * (of_both + f * by_up * up),
        )
        square[11 * LANES + k], square[14 * LANES + k] = near * f * by_up, n2 * c + off * off * f
        square[15 * LANES + k], square[16 * LANES + k] = 0.0, -off * near * f * up
        square[17 * LANES + k] = off * near * f
        square[21 * LANES + k], square[22 * LANES + k] = n2 * flow, -n2 * slope
        square[23 * LANES + k] = 0.0
        square[28 * LANES + k] = n2 * (d * right * right + e * left * left + f * up * up)
        square[29 * LANES + k], square[35 * LANES + k] = -n2 * f * up, n2 * f
    for k in range(width):
        near, off, up, by_up = view[_NEAR + k], view[_OFF + k], view[_UP + k], view[_BY_UP + k]
        right, left = view[_RIGHT + k], view[_LEFT + k]
        a, b = pulls[k], pulls[2 * LANES + k]
        c = pulls[LANES + k] + pulls[3 * LANES + k]
        d, e = pulls[4 * LANES + k], pulls[6 * LANES + k]
        f = pulls[5 * LANES + k] + pulls[7 * LANES + k]
        push[_X + k], push[_Z + k] = near * (a + b) + off * (d + e), near * c + off * f
        push[_Y + k] = (
            (d * view[_BY_RIGHT + k] + e * view[_BY_LEFT + k] + f * by_up)
            - near * (a * right + b * left + c * up)
            + pulls[8 * LANES + k] * baseline * near * near
        )
        push[_U + k], push[_W + k] = near * (d + e), near * f
        push[_V + k] = -near * (d * right + e * left + f * up)
    for a in range(6):
        for b in range(a):
            for k in range(width):
                square[LANES * (6 * a + b) + k] = square[LANES * (6 * b + a) + k]


@compiled
def told_of_arm(
    square: Array, arm: Array, body: Array, width: int, by_arm: Array, by_rate: Array, joint: Array
) -> None:
    """Write ``by_arm (3, 15)``, and add what tells of the motion to ``joint (3, 6, 6)``.

    That is of position and velocity together, of rate and attitude (first) with these, and of rate
    and attitude together. ``by_rate (3, 6)`` is for use in between.
    """
    for c in range(36):
        for k in range(width):
            joint[LANES * c + k] += square[LANES * c + k]
    for a in range(6):
        o, s, j = LANES * a, 6 * LANES * a, LANES * (36 + a)
        for k in range(width):
            flow = square[s + _U + k], square[s + _V + k], square[s + _W + k]
            x, y, z = cross(flow, three(body, _P + k))
            x, y, z = square[s + k] + x, square[s + _Y + k] + y, square[s + _Z + k] + z
            by_arm[o + k], by_arm[o + _COLUMN + k], by_arm[o + 2 * _COLUMN + k] = x, y, z
            x, y, z = cross(three(arm, k), flow)
            by_rate[o + k], by_rate[o + 6 * LANES + k], by_rate[o + 12 * LANES + k] = x, y, z
            joint[j + k] += x
            joint[j + 6 * LANES + k] += y
            joint[j + 12 * LANES + k] += z
    for b in range(3):
        o, s, j = _COLUMN * b, 6 * LANES * b, LANES * (72 + b)
        for k in range(width):
            flow = by_arm[o + _U + k], by_arm[o + _V + k], by_arm[o + _W + k]
            x, y, z = cross(flow, three(body, _P + k))
            own = by_arm[o + k] + x, by_arm[o + _Y + k] + y, by_arm[o + _Z + k] + z
            x, y, z = cross(three(arm, k), flow)
            by_arm[o + _P + k], by_arm[o + _Q + k], by_arm[o + _R + k] = x, y, z
            x, y, z = cross(three(arm, k), own)
            by_arm[o + 9 * LANES + k], by_arm[o + 10 * LANES + k] = x, y
            by_arm[o + 11 * LANES + k], by_arm[o + 12 * LANES + k] = z, own[0]
            by_arm[o + 13 * LANES + k], by_arm[o + 14 * LANES + k] = own[1], own[2]
        for k in range(width):
            flow = by_rate[s + _U + k], by_rate[s + _V + k], by_rate[s + _W + k]
            x, y, z = cross(three(arm, k), flow)
            joint[j + k] += x
            joint[j + 6 * LANES + k] += y
            joint[j + 12 * LANES + k] += z
    _add_attitude(arm, by_arm, width, joint)


@compiled
def _add_attitude(arm: Array, by_arm: Array, width: int, joint: Array) -> None:
    """Add what the attitude tells together with the motion."""
    for part in range(2):
        for a in range(6):
            o, j = LANES * (6 * part + a), LANES * (54 + 36 * part + a)
            for k in range(width):
                of_arm = by_arm[o + k], by_arm[o + _COLUMN + k], by_arm[o + 2 * _COLUMN + k]
                x, y, z = cross(three(arm, k), of_arm)
                joint[j + k] += x
                joint[j + 6 * LANES + k] += y
                joint[j + 12 * LANES + k] += z
    for b in range(3):
        for a in range(3):
            j, o = LANES * (75 + 6 * a + b), LANES * (90 + 6 * b + a)
            for k in range(width):
                joint[j + k] = joint[o + k]


@compiled
def to_body(by_arm: Array, body: Array, width: int) -> None:
    """Put the point in the body in the place of its arm: ``A D``, and its own ``D^T A D``."""
    for a in range(15):
        o = LANES * a
        for k in range(width):
            told = by_arm[o + k], by_arm[o + _COLUMN + k], by_arm[o + 2 * _COLUMN + k]
            x, y, z = _along_axes(body, k, told)
            by_arm[o + k], by_arm[o + _COLUMN + k], by_arm[o + 2 * _COLUMN + k] = x, y, z
    for b in range(3):
        o = _COLUMN * b + 12 * LANES
        for k in range(width):
            told = by_arm[o + k], by_arm[o + LANES + k], by_arm[o + 2 * LANES + k]
            x, y, z = _along_axes(body, k, told)
            by_arm[o + k], by_arm[o + LANES + k], by_arm[o + 2 * LANES + k] = x, y, z


@compiled
def _along_axes(body: Array, k: int, v: Vector) -> Vector:
    """Components of a vector along the target's axes."""
    a, b, c = three(body, _AXES + k), three(body, _AXES + _U + k), three(body, _AXES + _P + k)
    return (
        v[0] * a[0] + v[1] * a[1] + v[2] * a[2],
        v[0] * b[0] + v[1] * b[1] + v[2] * b[2],
        v[0] * c[0] + v[1] * c[1] + v[2] * c[2],
    )


@compiled
def forces(push: Array, arm: Array, body: Array, width: int, force: Array, own: Array) -> None:
    """Add what pulls at the motion to ``force (12)``; write what does at the point, ``own (3)``."""
    for k in range(width):
        flow, lever = three(push, _U + k), three(arm, k)
        x, y, z = cross(flow, three(body, _P + k))
        of_arm = push[_X + k] + x, push[_Y + k] + y, push[_Z + k] + z
        own[_X + k], own[_Y + k], own[_Z + k] = _along_axes(body, k, of_arm)
        force[_X + k] += push[_X + k]
        force[_Y + k] += push[_Y + k]
        force[_Z + k] += push[_Z + k]
        force[_U + k] += flow[0]
        force[_V + k] += flow[1]
        force[_W + k] += flow[2]
        x, y, z = cross(lever, flow)
        force[_P + k] += x
        force[_Q + k] += y
        force[_R + k] += z
        x, y, z = cross(lever, of_arm)
        force[9 * LANES + k] += x
        force[10 * LANES + k] += y
        force[11 * LANES + k] += z


@compiled
def add_six(way: Array, told: Array, width: int, to: Array) -> None:
    """Add six sums (6) of the products of ``way (6, 6)`` with ``told (6)``."""
    for k in range(width):
        t = three(told, k), three(told, _U + k)
        to[_X + k] += _sum(way, k, t)
        to[_Y + k] += _sum(way, 6 * LANES + k, t)
        to[_Z + k] += _sum(way, 12 * LANES + k, t)
        to[_U + k] += _sum(way, 18 * LANES + k, t)
        to[_V + k] += _sum(way, 24 * LANES + k, t)
        to[_W + k] += _sum(way, 30 * LANES + k, t)


@compiled
def add_two(way: Array, told: Array, width: int, to: Array) -> None:
    """Add two sums (2) of the products of ``way (2, 6)`` with ``told (6)``."""
    for k in range(width):
        t = three(told, k), three(told, _U + k)
        to[_X + k] += _sum(way, k, t)
        to[_Y + k] += _sum(way, 6 * LANES + k, t)


@compiled
def _sum(way: Array, k: int, told: tuple[Vector, Vector]) -> float:
    (a, b, c), (d, e, f) = three(way, k), three(way, _U + k)
    (x, y, z), (u, v, w) = told
    return (a * x + b * y) + (c * z + d * u) + (e * v + f * w)


@compiled
def three(lanes: Array, k: int) -> Vector:
    """Return a number of three lanes."""
    return lanes[k], lanes[LANES + k], lanes[2 * LANES + k]
