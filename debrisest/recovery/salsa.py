"""The split augmented Lagrangian iteration (SALSA) for lassos of many signals (Biondi et al. 2017).

It runs in single precision where that has the digits which are asked for, in half the time.
"""

from typing import Any, NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, ComplexArray, IntArray
from debrisest.recovery.fourier import analyse, share_taken, soft_threshold, synthesise

_ITERATIONS_BETWEEN_CHECKS = 10
_NUMBERS_IN_CACHE = 100_000
_LANES = 4
"""Rows that are transformed together in single precision; what is left over goes one by one."""
_SINGLE_TOLERANCE = 1e-4
"""What single precision can be asked for, with some digits to spare."""


class Lasso(NamedTuple):
    """Problems in rows: samples (row, component, time), zero where `weight` (the paper's tau) is.

    Components of a row share their lines.
    """

    samples: Array
    weight: Array
    length: int
    penalty: float
    splitting: float

    def rows(self, index: slice | IntArray | BoolArray) -> "Lasso":
        """Return the same of some signals."""
        return self._replace(samples=self.samples[index], weight=self.weight[index])

    def in_precision(self, real: Any) -> "Lasso":
        """Return the same with samples and weights in a precision."""
        return self._replace(samples=self.samples.astype(real), weight=self.weight.astype(real))


class Effort(NamedTuple):
    """How long and how closely a lasso is solved; see `basis_pursuit`."""

    iterations: int
    relaxation: float
    tolerance: float


def solve(lasso: Lasso, v: ComplexArray, effort: Effort) -> tuple[IntArray, BoolArray]:
    """Replace starts v (row, component, line) by solutions: iterations, whether converged (row).

    As many rows at a time as stay in the cache: 1.4 times as fast.
    """
    done, met = np.zeros(len(v), np.int64), np.zeros(len(v), bool)
    size = _NUMBERS_IN_CACHE // (lasso.length * max(1, v.shape[1]))
    size = max(_LANES, size // _LANES * _LANES)
    for begin in range(0, len(v), size):
        block = slice(begin, begin + size)
        met[block] = _solve(lasso.rows(block), v[block], done[block], effort)
    return done, met


def _solve(lasso: Lasso, v: ComplexArray, done: IntArray, effort: Effort) -> BoolArray:
    """In single precision first, as far as its digits go, where a tolerance in double is sought."""
    u = v.copy()
    if lasso.samples.dtype == np.float64 and effort.tolerance > 0:
        coarse = effort._replace(tolerance=max(effort.tolerance, _SINGLE_TOLERANCE))
        met = _advance(lasso.in_precision(np.float32), u, v, done, coarse)
        if effort.tolerance >= _SINGLE_TOLERANCE:
            return met
    return _advance(lasso, u, v, done, effort)


def _advance(
    lasso: Lasso, u: ComplexArray, v: ComplexArray, done: IntArray, effort: Effort
) -> BoolArray:
    """Advance u, v and `done` in place until each row has converged or is at the limit."""
    met, row = np.zeros(len(u), bool), np.flatnonzero(done < effort.iterations)
    runs = np.arange(_whole_vectors(len(row), u.shape[1])) < len(row)
    row = np.resize(row, len(runs))
    lasso, now = lasso.rows(row), u[row].astype(np.result_type(lasso.samples, np.complex64))
    near = effort.tolerance * _norm(lasso.samples) / lasso.length**0.5
    steps = _ITERATIONS_BETWEEN_CHECKS if effort.tolerance > 0 else effort.iterations
    while runs.any():
        count = min(steps, effort.iterations - int(done[row[runs]].max()))
        found, gap = _iterate(lasso, now, count, effort.relaxation)
        done[row[runs]] += count
        ends = runs & ((gap <= near) | (done[row] >= effort.iterations))
        out = row[ends]
        u[out], v[out], met[out] = now[ends], found[ends], (gap <= near)[ends]
        runs &= ~ends
        stays = _filled(runs, u.shape[1])
        if not stays.all():
            lasso, now = lasso.rows(stays), now[stays]
            row, near, runs = row[stays], near[stays], runs[stays]
    return met


def _filled(runs: BoolArray, components: int) -> BoolArray:
    """Mark also some rows (row) that have ended, for full vectors: what they still do is lost."""
    stays, count = runs.copy(), int(runs.sum())
    stays[np.flatnonzero(~runs)[: _whole_vectors(count, components) - count]] = True
    return stays


def _whole_vectors(rows: int, components: int) -> int:
    """Return a number of rows, at least as many, that fills vectors; several components do."""
    return rows if components > 1 else -(-rows // _LANES) * _LANES


def _iterate(
    lasso: Lasso, u: ComplexArray, iterations: int, relaxation: float
) -> tuple[ComplexArray, Array]:
    """Advance u (row, component, line) in place; v, and the norm (row) of v - c.

    With u = v + l (Eq. 23) and g = c - u = -l an iteration of Eqs. 21-27 is g = Phi*(tau (s -
    Phi u)) / (mu + n), v = soft(u + 2 g, lambda / mu), u = v - g, here relaxed to u + relaxation
    (v - u - g). The listing after Eq. 27 has the old u in its second line; the new one is meant.
    With z = u + 2 g, c = (u + z) / 2: u is what is left of a mean of u and z.
    """
    joint, length, samples = u.shape[1] > 1, lasso.length, lasso.samples.shape[-1]
    gain = lasso.weight * (-2.0 / ((lasso.splitting + 1.0) * length))
    pull = -gain * lasso.samples
    threshold = lasso.penalty / (lasso.splitting * length)
    residual = np.zeros((*u.shape[:-1], length), gain.dtype)
    used = residual[..., :samples]
    for left in range(iterations, 0, -1):
        np.multiply(synthesise(u, length, samples), gain, out=used)
        used += pull
        z = analyse(residual, length)
        z += u
        if left == 1:
            v = soft_threshold(z, threshold, joint=joint)
            gap = _norm(v - 0.5 * (u + z))
        share = share_taken(z, threshold, joint=joint)
        np.subtract(0.5, share, out=share)
        share *= relaxation
        u *= 1.0 - 0.5 * relaxation
        z *= share
        u += z
    return v, gap


def _norm(rows: Array | ComplexArray) -> Array:
    """2-norm (row) of samples or half spectra (row, component, ...)."""
    parts = rows.view(rows.real.dtype)
    norm: Array = np.sqrt(np.sum(parts * parts, axis=(-2, -1)))
    return norm
