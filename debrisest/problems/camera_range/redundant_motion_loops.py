"""The core's motion of `redundant_model` as plain loops over points, for `debrisest.compiled`.

Points are the last axis of flat arrays ``(component x LANES,)``, so that each loop becomes vectors.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

CORE, BODY = 19, 13
"""Where points begin in the state, and the elements of the inertia."""
LANES = 40
"""Points that are moved together, whole vectors of them."""
Steps = tuple[Array, Array, Array]
_PARTS, _WEIGHTS = (0.5, 0.5, 1.0, 0.0), (1.0, 2.0, 2.0, 1.0)


@compiled
def moved_core(
    core: Array, orbit: Array, pace: tuple[float, float], duration: float, new: Array, turned: Array
) -> None:
    """Write a core ``(19 x LANES,)`` one step later, without the inertia, and how matters turn.

    ``turned (10 x LANES,)`` is the change of the rotation matrix, and of the distance.
    """
    before, room, body = np.empty(4 * LANES), np.empty(4 * LANES), np.empty(6 * LANES)
    steps = np.empty(7 * LANES), np.empty(7 * LANES), np.empty(7 * LANES)
    _in_orbit(core, orbit, new)
    _unit(core, before)
    _camera(core, room)
    _product(room, before, steps[0], 1.0)
    _inverse(core, body)
    _turned(core, body, pace, duration, steps, new)
    _camera(new, room)
    _product(room, steps[0], new, -1.0)
    _change(before, core, new, turned)


@compiled
def _in_orbit(core: Array, orbit: Array, new: Array) -> None:
    for a in range(6):
        for t in range(LANES):
            new[(7 + a) * LANES + t] = 0.0
        for b in range(6):
            by = orbit[a, b]
            for t in range(LANES):
                new[(7 + a) * LANES + t] += by * core[(7 + b) * LANES + t]


@compiled
def _unit(q: Array, unit: Array) -> None:
    for t in range(LANES):
        a, b = q[t], q[LANES + t]
        c, d = q[2 * LANES + t], q[3 * LANES + t]
        scale = 1.0 / np.sqrt(a * a + b * b + c * c + d * d)
        unit[t], unit[LANES + t] = scale * a, scale * b
        unit[2 * LANES + t], unit[3 * LANES + t] = scale * c, scale * d


@compiled
def _camera(core: Array, q: Array) -> None:
    """Write the attitude of `camera_axes` up to its sign: two half turns of a level and of a tilt.

    Half an angle's cosine and sine are as 1 + cos is to sin, or as sin to 1 - cos.
    """
    for t in range(LANES):
        x, y, z = core[7 * LANES + t], core[8 * LANES + t], core[9 * LANES + t]
        level = np.sqrt(x * x + y * y)
        far = np.sqrt(x * x + y * y + z * z)
        cos, sin = (level - y, x) if y <= 0.0 else (x, level + y)
        scale = 1.0 / np.sqrt(cos * cos + sin * sin)
        cos, sin = scale * cos, scale * sin
        up, tilt = (far - z, -level) if z <= 0.0 else (-level, far + z)
        scale = 1.0 / np.sqrt(up * up + tilt * tilt)
        up, tilt = scale * up, scale * tilt
        q[t], q[LANES + t] = cos * up, cos * tilt
        q[2 * LANES + t], q[3 * LANES + t] = sin * tilt, sin * up


@compiled
def _product(p: Array, q: Array, result: Array, sign: float) -> None:
    """Write the product of two quaternions, of the conjugate of the first if the sign is -1."""
    for t in range(LANES):
        a, b = p[t], sign * p[LANES + t]
        c, d = sign * p[2 * LANES + t], sign * p[3 * LANES + t]
        w, x, y, z = q[t], q[LANES + t], q[2 * LANES + t], q[3 * LANES + t]
        result[t] = a * w - b * x - c * y - d * z
        result[LANES + t] = a * x + b * w + c * z - d * y
        result[2 * LANES + t] = a * y - b * z + c * w + d * x
        result[3 * LANES + t] = a * z + b * y - c * x + d * w


@compiled
def _inverse(core: Array, inverse: Array) -> None:
    """Write the inverse of the inertia, in the order of its elements."""
    for t in range(LANES):
        xx, yy, zz = core[13 * LANES + t], core[14 * LANES + t], core[15 * LANES + t]
        xy, xz, yz = core[16 * LANES + t], core[17 * LANES + t], core[18 * LANES + t]
        a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
        scale = 1.0 / (xx * a + xy * b + xz * c)
        inverse[t], inverse[3 * LANES + t], inverse[4 * LANES + t] = a * scale, b * scale, c * scale
        inverse[LANES + t] = (xx * zz - xz * xz) * scale
        inverse[2 * LANES + t] = (xx * yy - xy * xy) * scale
        inverse[5 * LANES + t] = (xy * xz - xx * yz) * scale


@compiled
def _turned(
    core: Array,
    inverse: Array,
    pace: tuple[float, float],
    duration: float,
    steps: Steps,
    new: Array,
) -> None:
    """Replace the attitude to the Hill frame in the first row of steps, and write the new rate."""
    total, tried, slope = steps
    start = np.empty(7 * LANES)
    for t in range(4 * LANES):
        start[t] = tried[t] = total[t]
    for t in range(4 * LANES, 7 * LANES):
        start[t] = tried[t] = total[t] = core[t]
    for i in range(4):
        _slopes(tried, core, inverse, pace, slope)
        part, weight = _PARTS[i] * duration, _WEIGHTS[i] * duration / 6.0
        for t in range(7 * LANES):
            tried[t] = start[t] + part * slope[t]
            total[t] += weight * slope[t]
    _unit(total, total)
    for t in range(4 * LANES, 7 * LANES):
        new[t] = total[t]


@compiled
def _slopes(
    at: Array, core: Array, inverse: Array, pace: tuple[float, float], slope: Array
) -> None:
    """Write the derivatives of attitude (4) and rate (3), as `tumbling_in_orbit` has them."""
    mean_motion, gravity = pace
    for t in range(LANES):
        a, b, c, d = at[t], at[LANES + t], at[2 * LANES + t], at[3 * LANES + t]
        u, v, w = at[4 * LANES + t], at[5 * LANES + t], at[6 * LANES + t]
        r = u - mean_motion * 2.0 * (b * d - a * c)
        s = v - mean_motion * 2.0 * (c * d + a * b)
        p = w - mean_motion * (a * a - b * b - c * c + d * d)
        slope[t] = -0.5 * (b * r + c * s + d * p)
        slope[LANES + t] = 0.5 * (a * r + c * p - d * s)
        slope[2 * LANES + t] = 0.5 * (a * s + d * r - b * p)
        slope[3 * LANES + t] = 0.5 * (a * p + b * s - c * r)
        x, y = a * a + b * b - c * c - d * d, 2.0 * (b * c - a * d)
        z = 2.0 * (b * d + a * c)
        xx, yy, zz = core[13 * LANES + t], core[14 * LANES + t], core[15 * LANES + t]
        xy, xz, yz = core[16 * LANES + t], core[17 * LANES + t], core[18 * LANES + t]
        i, j, k = xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z
        e, f, g = xx * u + xy * v + xz * w, xy * u + yy * v + yz * w, xz * u + yz * v + zz * w
        x, y, z = y * k - z * j, z * i - x * k, x * j - y * i
        x, y, z = (
            gravity * x - (v * g - w * f),
            gravity * y - (w * e - u * g),
            gravity * z - (u * f - v * e),
        )
        xx, yy, zz = inverse[t], inverse[LANES + t], inverse[2 * LANES + t]
        xy, xz, yz = inverse[3 * LANES + t], inverse[4 * LANES + t], inverse[5 * LANES + t]
        slope[4 * LANES + t] = xx * x + xy * y + xz * z
        slope[5 * LANES + t] = xy * x + yy * y + yz * z
        slope[6 * LANES + t] = xz * x + yz * y + zz * z


@compiled
def _change(before: Array, core: Array, new: Array, turned: Array) -> None:
    """Bring quaternions near those before; write how their matrices change, and the distance."""
    for t in range(LANES):
        a, b, c, d = before[t], before[LANES + t], before[2 * LANES + t], before[3 * LANES + t]
        w, x, y, z = new[t], new[LANES + t], new[2 * LANES + t], new[3 * LANES + t]
        sign = -1.0 if a * w + b * x + c * y + d * z < 0.0 else 1.0
        new[t], new[LANES + t] = sign * w, sign * x
        new[2 * LANES + t], new[3 * LANES + t] = sign * y, sign * z
        turned[t] = 2.0 * (c * c + d * d - y * y - z * z)
        turned[4 * LANES + t] = 2.0 * (b * b + d * d - x * x - z * z)
        turned[8 * LANES + t] = 2.0 * (b * b + c * c - x * x - y * y)
        turned[LANES + t] = 2.0 * (x * y - w * z - b * c + a * d)
        turned[3 * LANES + t] = 2.0 * (x * y + w * z - b * c - a * d)
        turned[2 * LANES + t] = 2.0 * (x * z + w * y - b * d - a * c)
        turned[6 * LANES + t] = 2.0 * (x * z - w * y - b * d + a * c)
        turned[5 * LANES + t] = 2.0 * (y * z - w * x - c * d + a * b)
        turned[7 * LANES + t] = 2.0 * (y * z + w * x - c * d - a * b)
    for t in range(LANES):
        turned[9 * LANES + t] = np.sqrt(
            new[7 * LANES + t] ** 2 + new[8 * LANES + t] ** 2 + new[9 * LANES + t] ** 2
        ) - np.sqrt(core[7 * LANES + t] ** 2 + core[8 * LANES + t] ** 2 + core[9 * LANES + t] ** 2)
