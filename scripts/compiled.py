"""The 14-state unscented filter as plain loops that numba compiles: what numpy is held against.

Model and filter are those of `debrisest.problems.tumbling.attitude` and
`debrisest.filters.kalman.unscented` (points drawn again, alpha 1, beta 2, kappa 0), written out for
one run after the other.
"""

import math
from typing import Any

import numpy as np
from numba import njit

N, M = 14, 4
LEAST_MOMENT, LARGEST_TURN = 0.02, 0.1


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _derivative(x: Any, ratio: Any, out: Any) -> None:
    q0, q1, q2, q3, w1, w2, w3 = x
    out[0] = -0.5 * (q1 * w1 + q2 * w2 + q3 * w3)
    out[1] = 0.5 * (q0 * w1 + q2 * w3 - q3 * w2)
    out[2] = 0.5 * (q0 * w2 + q3 * w1 - q1 * w3)
    out[3] = 0.5 * (q0 * w3 + q1 * w2 - q2 * w1)
    out[4], out[5], out[6] = ratio[0] * w2 * w3, ratio[1] * w3 * w1, ratio[2] * w1 * w2


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _process(state: Any, step: float, x: Any, k: Any, tried: Any, ratio: Any) -> None:
    """Move a state by Runge-Kutta steps that turn little."""
    x[:4], x[4:] = state[:4], state[8:11]
    a, b, c = state[11], state[12], state[13]
    a = math.copysign(max(abs(a), LEAST_MOMENT), a)
    b = math.copysign(max(abs(b), LEAST_MOMENT), b)
    c = math.copysign(max(abs(c), LEAST_MOMENT), c)
    ratio[0], ratio[1], ratio[2] = (b - c) / a, (c - a) / b, (a - b) / c
    speed = math.sqrt(x[4] ** 2 + x[5] ** 2 + x[6] ** 2)
    count = max(1, math.ceil(speed * step / LARGEST_TURN))
    h = step / count
    for _ in range(count):
        _derivative(x, ratio, k[0])
        for stage in range(1, 4):
            part = h if stage == 3 else 0.5 * h
            for i in range(7):
                tried[i] = x[i] + part * k[stage - 1, i]
            _derivative(tried, ratio, k[stage])
        for i in range(7):
            x[i] += h / 6 * (k[0, i] + 2 * (k[1, i] + k[2, i]) + k[3, i])
    state[:4], state[8:11] = x[:4], x[4:]


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _factor(a: Any, root: Any, n: int) -> None:
    """Write the lower Cholesky factor of a matrix (n, n)."""
    for j in range(n):
        for i in range(j, n):
            total = a[i, j]
            for k in range(j):
                total -= root[i, k] * root[j, k]
            root[i, j] = math.sqrt(total) if i == j else total / root[j, j]


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _draw(mean: Any, p: Any, root: Any, points: Any) -> None:
    _factor(p, root, N)
    scale = math.sqrt(N)
    for i in range(N):
        points[0, i] = mean[i]
        for j in range(N):
            error = scale * root[i, j] if j <= i else 0.0
            points[1 + j, i], points[1 + N + j, i] = mean[i] + error, mean[i] - error


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _moment(deviations: Any, added: Any, p: Any) -> None:
    """Write the weighted second moment of deviations (point, n), with a covariance added."""
    outer = 0.5 / N
    for i in range(N):
        for j in range(i + 1):
            total = 0.0
            for point in range(1, 2 * N + 1):
                total += deviations[point, i] * deviations[point, j]
            total = outer * total + 2.0 * deviations[0, i] * deviations[0, j] + added[i, j]
            p[i, j], p[j, i] = total, total


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _mean(points: Any, mean: Any) -> None:
    for i in range(points.shape[1]):
        total = 0.0
        for point in range(1, len(points)):
            total += points[point, i] - points[0, i]
        mean[i] = points[0, i] + 0.5 / N * total


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _measure(x: Any, y: Any) -> None:
    a0, a1, a2, a3 = x[0], x[1], x[2], x[3]
    b0, b1, b2, b3 = x[4], x[5], x[6], x[7]
    y[0] = a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3
    y[1] = a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2
    y[2] = a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1
    y[3] = a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _scale(x: Any, first: int, end: int) -> None:
    total = 0.0
    for i in range(first, end):
        total += x[i] * x[i]
    for i in range(first, end):
        x[i] /= math.sqrt(total)


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def compiled_states(
    start: Any, covariance: Any, measured: Any, q: Any, noise: float, step: float
) -> Any:
    """Return the states (run, time, 14); ``q (14, 14)`` is the process noise of a step."""
    runs, epochs = measured.shape[:2]
    states = np.empty((runs, epochs, N))
    points, shown = np.empty((2 * N + 1, N)), np.empty((2 * N + 1, M))
    root, p = np.zeros((N, N)), np.empty((N, N))
    small, s = np.zeros((M, M)), np.empty((M, M))
    gain, x, expected, nu = np.empty((M, N)), np.empty(N), np.empty(M), np.empty(M)
    moving, k, tried, ratio = np.empty(7), np.empty((4, 7)), np.empty(7), np.empty(3)
    added = np.empty((N, N))
    for run in range(runs):
        x[:], p[:] = start[run], covariance[run]
        for epoch in range(epochs):
            _draw(x, p, root, points)
            if epoch:
                for point in range(2 * N + 1):
                    _process(points[point], step, moving, k, tried, ratio)
                _mean(points, x)
                for point in range(2 * N + 1):
                    for i in range(N):
                        points[point, i] -= x[i]
                _moment(points, q, p)
                _draw(x, p, root, points)
            for point in range(2 * N + 1):
                _measure(points[point], shown[point])
            _mean(shown, expected)
            product = 0.0
            for i in range(M):
                product += measured[run, epoch, i] * expected[i]
            for i in range(M):
                nu[i] = math.copysign(1.0, product) * measured[run, epoch, i] - expected[i]
            for point in range(2 * N + 1):
                for i in range(N):
                    points[point, i] -= x[i]
                for i in range(M):
                    shown[point, i] -= expected[i]
            _gain(points, shown, noise, s, small, gain)
            for point in range(2 * N + 1):
                for i in range(N):
                    for j in range(M):
                        points[point, i] -= shown[point, j] * gain[j, i]
            for i in range(N):
                for j in range(N):
                    total = 0.0
                    for m in range(M):
                        total += gain[m, i] * gain[m, j]
                    added[i, j] = noise * total
            _moment(points, added, p)
            for i in range(N):
                for j in range(M):
                    x[i] += nu[j] * gain[j, i]
            _scale(x, 0, 4)
            _scale(x, 4, 8)
            _scale(x, 11, 14)
            states[run, epoch] = x
    return states


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _gain(points: Any, shown: Any, noise: float, s: Any, root: Any, gain: Any) -> None:
    """Write the gain (M, N) from the deviations of states and measurements."""
    outer = 0.5 / N
    for i in range(M):
        for j in range(M):
            total = 0.0
            for point in range(1, 2 * N + 1):
                total += shown[point, i] * shown[point, j]
            s[i, j] = outer * total + 2.0 * shown[0, i] * shown[0, j]
        s[i, i] += noise
        for j in range(N):
            total = 0.0
            for point in range(1, 2 * N + 1):
                total += shown[point, i] * points[point, j]
            gain[i, j] = outer * total + 2.0 * shown[0, i] * points[0, j]
    _factor(s, root, M)
    for j in range(N):
        for i in range(M):
            for k in range(i):
                gain[i, j] -= root[i, k] * gain[k, j]
            gain[i, j] /= root[i, i]
        for i in range(M - 1, -1, -1):
            for k in range(i + 1, M):
                gain[i, j] -= root[k, i] * gain[k, j]
            gain[i, j] /= root[i, i]
