"""Points of unknown places against attitudes as plain loops over epochs, for `debrisest.compiled`.

The formulas are those of `free_points`, `align_clouds` and `point_sums`, where their words are.
``points (time, feature, 3)`` and ``weight (time, feature)`` are those of tracks, ``model (feature,
3)`` places in the body, ``q (time, 4)`` attitudes, NaN of epochs that are left out.
"""

import numpy as np

from debrisest.array_loops import fill, fill_rows
from debrisest.arrays import Array
from debrisest.attitude.nearest_loops import nearest
from debrisest.attitude.rotation_loops import Vector, inner, rows_of
from debrisest.compiled import compiled

_LEAST_SHARE = 0.3
_TELLS_A_TURN = 4.0


@compiled
def attitudes(points: Array, weight: Array, model: Array) -> Array:
    """Return the attitudes of epochs that tell all three directions, NaN elsewhere."""
    q = np.full((len(points), 4), np.nan)
    measured, body = np.empty(model.shape), np.empty(model.shape)
    davenport, adjugate = np.empty((4, 4)), np.empty((4, 4))
    product, spread = np.empty((3, 3)), np.empty((3, 3))
    for t in range(len(points)):
        _centre(points[t], weight[t], measured)
        _centre(model, weight[t], body)
        fill_rows(0.0, product)
        fill_rows(0.0, spread)
        for n in range(len(model)):
            for i in range(3):
                for j in range(3):
                    product[i, j] += weight[t, n] * measured[n, i] * body[n, j]
                    spread[i, j] += weight[t, n] * body[n, i] * body[n, j]
        if _tells(spread):
            q[t, 0], q[t, 1], q[t, 2], q[t, 3] = nearest(product, davenport, adjugate)
    return q


@compiled
def pulled(points: Array, weight: Array, q: Array) -> Array:
    """Return the pull (feature, 3) on the places of the points, zero of what is not seen."""
    pull, measured = np.zeros(points.shape[1:]), np.empty(points.shape[1:])
    for t in range(len(points)):
        x, y, z = _columns(q[t])
        _centre(points[t], weight[t], measured)
        for n in range(len(pull)):
            w, point = weight[t, n], _vector(measured, n)
            pull[n, 0] += w * inner(x, point)
            pull[n, 1] += w * inner(y, point)
            pull[n, 2] += w * inner(z, point)
    return pull


@compiled
def residual_squares(points: Array, weight: Array, model: Array, q: Array) -> tuple[Array, Array]:
    """Return squares of the residuals in sigmas, and what the noise lets expect (time, feature)."""
    square, own = np.empty(weight.shape), np.empty(weight.shape)
    measured, body = np.empty(model.shape), np.empty(model.shape)
    for t in range(len(points)):
        r, s, u = rows_of((q[t, 0], q[t, 1], q[t, 2], q[t, 3]))
        total = max(_centre(points[t], weight[t], measured), np.finfo(np.float64).tiny)
        _centre(model, weight[t], body)
        for n in range(len(model)):
            place = _vector(body, n)
            x, y = measured[n, 0] - inner(r, place), measured[n, 1] - inner(s, place)
            z = measured[n, 2] - inner(u, place)
            square[t, n] = (x * x + y * y + z * z) * weight[t, n]
            own[t, n] = max(1.0 - weight[t, n] / total, _LEAST_SHARE)
    return square, own


@compiled
def told(points: Array, weight: Array, model: Array, q: Array) -> tuple[Array, Array, Array]:
    """Return chi-squares (time,), pull (time, 3) and information (time, 3, 3) of attitudes."""
    chi2, pull, hold = np.zeros(len(q)), np.zeros((len(q), 3)), np.zeros((len(q), 3, 3))
    measured, body = np.empty(model.shape), np.empty(model.shape)
    for t in range(len(points)):
        _centre(points[t], weight[t], measured)
        _centre(model, weight[t], body)
        chi2[t] = _tell(measured, body, weight[t], q[t], pull[t], hold[t])
    return chi2, pull, hold


@compiled
def normal(
    points: Array, weight: Array, inverse: Array, q: Array, turn_by: Array
) -> tuple[Array, Array, Array]:
    """Return chi-squares (arc,), pulls (arc, 11), information (arc, 11, 11), points at their best.

    ``inverse (feature, feature)`` is the inverse Laplacian, ``q (arc, time, 4)``, ``turn_by (arc,
    time, 3, 11)`` are derivatives of the attitudes.
    """
    arcs, features = len(q), points.shape[1]
    chi2, pulls, holds = np.empty(arcs), np.zeros((arcs, 11)), np.zeros((arcs, 11, 11))
    cross, moved = np.empty((features, 3, 11)), np.empty((3, 11))
    for k in range(arcs):
        model = best_places(inverse, pulled(points, weight, q[k]))
        chi2[k] = _at_rest(points, weight, model, q[k], turn_by[k], pulls[k], holds[k], cross)
        for n in range(features):
            _spend(inverse[n], cross, cross[n], holds[k], moved)
    return chi2, pulls, holds


@compiled
def _spend(inverse: Array, cross: Array, own: Array, hold: Array, moved: Array) -> None:
    """Take from the information (11, 11) what the place of a point takes; ``moved`` is scratch."""
    fill_rows(0.0, moved)
    for n in range(len(inverse)):
        for i in range(3):
            for a in range(11):
                moved[i, a] += inverse[n] * cross[n, i, a]
    for i in range(3):
        for a in range(11):
            for b in range(11):
                hold[a, b] -= own[i, a] * moved[i, b]


@compiled
def best_places(inverse: Array, pull: Array) -> Array:
    """Return the places (feature, 3) that fit best."""
    model = np.zeros(pull.shape)
    for m in range(len(pull)):
        for n in range(len(pull)):
            for i in range(3):
                model[m, i] += inverse[m, n] * pull[n, i]
    return model


@compiled
def _at_rest(
    points: Array,
    weight: Array,
    model: Array,
    q: Array,
    turn_by: Array,
    pulls: Array,
    holds: Array,
    cross: Array,
) -> float:
    """Add up pull and information of an arc, the points where they are; return the chi-square.

    ``cross`` is the information (feature, 3, 11) between places and unknowns.
    """
    chi2, turned = 0.0, np.empty((3, 11))
    for n in range(len(cross)):
        fill_rows(0.0, cross[n])
    measured, body = np.empty(model.shape), np.empty(model.shape)
    pull, hold = np.empty(3), np.empty((3, 3))
    for t in range(len(points)):
        _centre(points[t], weight[t], measured)
        _centre(model, weight[t], body)
        fill(0.0, pull)
        fill_rows(0.0, hold)
        chi2 += _tell(measured, body, weight[t], q[t], pull, hold)
        by = turn_by[t]
        _multiplied(hold, by, turned)
        for a in range(11):
            pulls[a] += by[0, a] * pull[0] + by[1, a] * pull[1] + by[2, a] * pull[2]
            for b in range(11):
                more = by[0, a] * turned[0, b] + by[1, a] * turned[1, b] + by[2, a] * turned[2, b]
                holds[a, b] += more
        for i, row in enumerate(_columns(q[t])):
            for j in range(3):
                hold[i, j] = row[j]
        _multiplied(hold, by, turned)
        for n in range(len(model)):
            w, (x, y, z) = weight[t, n], _vector(body, n)
            for a in range(11):
                cross[n, 0, a] += w * (z * turned[1, a] - y * turned[2, a])
                cross[n, 1, a] += w * (x * turned[2, a] - z * turned[0, a])
                cross[n, 2, a] += w * (y * turned[0, a] - x * turned[1, a])
    return chi2


@compiled
def _centre(vectors: Array, weight: Array, result: Array) -> float:
    """Write vectors (feature, 3) less their mean; return the sum of the weights."""
    total, x, y, z = 0.0, 0.0, 0.0, 0.0
    for n in range(len(weight)):
        total += weight[n]
        x += weight[n] * vectors[n, 0]
        y += weight[n] * vectors[n, 1]
        z += weight[n] * vectors[n, 2]
    per = 1.0 / max(total, np.finfo(np.float64).tiny)
    for n in range(len(weight)):
        result[n, 0], result[n, 1] = vectors[n, 0] - x * per, vectors[n, 1] - y * per
        result[n, 2] = vectors[n, 2] - z * per
    return total


@compiled
def _tell(measured: Array, body: Array, weight: Array, q: Array, pull: Array, hold: Array) -> float:
    """Add pull (3) and information (3, 3) of an attitude; return its chi-square."""
    r, s, u = rows_of((q[0], q[1], q[2], q[3]))
    chi2 = 0.0
    for n in range(len(weight)):
        w, place = weight[n], _vector(body, n)
        x, y, z = inner(r, place), inner(s, place), inner(u, place)
        a, b, c = measured[n, 0], measured[n, 1], measured[n, 2]
        chi2 += w * ((a - x) ** 2 + (b - y) ** 2 + (c - z) ** 2)
        pull[0] += w * (y * c - z * b)
        pull[1] += w * (z * a - x * c)
        pull[2] += w * (x * b - y * a)
        hold[0, 0] += w * (y * y + z * z)
        hold[1, 1] += w * (z * z + x * x)
        hold[2, 2] += w * (x * x + y * y)
        hold[0, 1] -= w * x * y
        hold[0, 2] -= w * x * z
        hold[1, 2] -= w * y * z
    hold[1, 0], hold[2, 0], hold[2, 1] = hold[0, 1], hold[0, 2], hold[1, 2]
    return chi2


@compiled
def _tells(spread: Array) -> bool:
    """Whether an attitude is told about all axes: eigenvalues of tr(F) I - F are large enough."""
    trace = spread[0, 0] + spread[1, 1] + spread[2, 2] - _TELLS_A_TURN
    a, b, c = trace - spread[0, 0], trace - spread[1, 1], trace - spread[2, 2]
    d, e, f = -spread[0, 1], -spread[0, 2], -spread[1, 2]
    minor = a * b - d * d
    whole = c * minor - a * f * f - b * e * e + 2.0 * d * e * f
    return bool(a > 0.0 and minor > 0.0 and whole > 0.0)


@compiled
def _columns(q: Array) -> tuple[Vector, Vector, Vector]:
    """Columns of the rotation matrix: what takes inertial vectors to the body."""
    return rows_of((q[0], -q[1], -q[2], -q[3]))


@compiled
def _vector(vectors: Array, n: int) -> Vector:
    return vectors[n, 0], vectors[n, 1], vectors[n, 2]


@compiled
def _multiplied(matrix: Array, by: Array, result: Array) -> None:
    """Write the product (3, 11) of a matrix (3, 3) with another."""
    for i in range(3):
        x, y, z = _vector(matrix, i)
        for a in range(by.shape[1]):
            result[i, a] = x * by[0, a] + y * by[1, a] + z * by[2, a]
