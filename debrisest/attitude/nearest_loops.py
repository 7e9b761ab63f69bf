"""The rotation nearest to a matrix, for compiled loops: the formulas of `quaternion.nearest`."""

import math

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.quaternion import ABOVE, NEWTON_STEPS
from debrisest.attitude.rotation_loops import Quaternion
from debrisest.compiled import compiled


@compiled
def nearest(matrix: Array, davenport: Array, adjugate: Array) -> Quaternion:
    """Return its unit quaternion, scalar part not negative; the last two (4, 4) are scratch."""
    size = math.sqrt(np.sum(matrix * matrix))
    per = 1.0 / max(size, np.finfo(np.float64).tiny)
    a, b, c = per * matrix[0, 0], per * matrix[0, 1], per * matrix[0, 2]
    d, e, f = per * matrix[1, 0], per * matrix[1, 1], per * matrix[1, 2]
    g, h, i = per * matrix[2, 0], per * matrix[2, 1], per * matrix[2, 2]
    davenport[0, 0], davenport[1, 1] = a + e + i, a - e - i
    davenport[2, 2], davenport[3, 3] = e - a - i, i - a - e
    davenport[0, 1], davenport[0, 2], davenport[0, 3] = h - f, c - g, d - b
    davenport[1, 2], davenport[1, 3], davenport[2, 3] = b + d, c + g, f + h
    linear = -8.0 * (a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g))
    value = _largest_root(linear, _adjugate(davenport, adjugate)) + ABOVE
    for k in range(4):
        for j in range(k, 4):
            davenport[k, j] = -davenport[k, j]
        davenport[k, k] += value
    _adjugate(davenport, adjugate)
    k = 0
    for j in range(1, 4):
        k = j if adjugate[j, j] > adjugate[k, k] else k
    w, x, y, z = adjugate[k]
    return _positive(_times(adjugate, _positive((w, x, y, z))))


@compiled
def _largest_root(linear: float, constant: float) -> float:
    """Largest eigenvalue, by Newton's steps from above."""
    value = math.sqrt(3.0)
    for _ in range(NEWTON_STEPS):
        square = value * value
        slope = max(4.0 * value * (square - 1.0) + linear, 1e-8)
        step = ((square - 2.0) * square + linear * value + constant) / slope
        value -= max(step, 0.0)
        if not step > 1e-13:
            break
    return value


@compiled
def _adjugate(m: Array, adjugate: Array) -> float:
    """Write that of a symmetric matrix (4, 4) of which the upper part is read; return det."""
    a, b, c, d = m[0, 0], m[0, 1], m[0, 2], m[0, 3]
    e, f, g, h, i, j = m[1, 1], m[1, 2], m[1, 3], m[2, 2], m[2, 3], m[3, 3]
    s0, s1, s2 = a * e - b * b, a * f - b * c, a * g - b * d
    s3, s4, s5 = b * f - e * c, b * g - e * d, c * g - f * d
    c5, c4, c3 = h * j - i * i, f * j - g * i, f * i - g * h
    c2, c1, c0 = c * j - d * i, c * i - d * h, c * g - d * f
    adjugate[0, 0], adjugate[0, 1] = e * c5 - f * c4 + g * c3, c * c4 - b * c5 - d * c3
    adjugate[0, 2], adjugate[0, 3] = g * s5 - i * s4 + j * s3, h * s4 - f * s5 - i * s3
    adjugate[1, 1], adjugate[1, 2] = a * c5 - c * c2 + d * c1, i * s2 - d * s5 - j * s1
    adjugate[1, 3], adjugate[2, 2] = c * s5 - h * s2 + i * s1, d * s4 - g * s2 + j * s0
    adjugate[2, 3], adjugate[3, 3] = f * s2 - c * s4 - i * s0, c * s3 - f * s1 + h * s0
    for k in range(4):
        for n in range(k):
            adjugate[k, n] = adjugate[n, k]
    return float(s0 * c5 - s1 * c4 + s2 * c3 + s3 * c2 - s4 * c1 + s5 * c0)


@compiled
def _times(matrix: Array, q: Quaternion) -> Quaternion:
    w, x, y, z = q
    return (
        matrix[0, 0] * w + matrix[0, 1] * x + matrix[0, 2] * y + matrix[0, 3] * z,
        matrix[1, 0] * w + matrix[1, 1] * x + matrix[1, 2] * y + matrix[1, 3] * z,
        matrix[2, 0] * w + matrix[2, 1] * x + matrix[2, 2] * y + matrix[2, 3] * z,
        matrix[3, 0] * w + matrix[3, 1] * x + matrix[3, 2] * y + matrix[3, 3] * z,
    )


@compiled
def _positive(q: Quaternion) -> Quaternion:
    w, x, y, z = q
    size = math.sqrt(w * w + x * x + y * y + z * z)
    per = -1.0 / size if w < 0.0 else 1.0 / size
    return per * w, per * x, per * y, per * z
