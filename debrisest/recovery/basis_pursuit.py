"""Basis pursuit denoising by SALSA, batched (Biondi et al. 2017, Sec. 3).

A signal with missing samples is explained by few atoms of the Fourier dictionary: the lasso

    minimise  1/2 |s - H Phi v|_2^2 + lambda |v|_1                                     (Eq. 19)

over the complex coefficients v, where H picks the observed epochs. Components of one motion have
their lines in common; jointly, |v|_1 is the sum over the lines of the 2-norm over the components
(group lasso, Yuan and Lin 2006), which the paper does not have.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, ComplexArray, IntArray
from debrisest.outcome import Outcome
from debrisest.recovery.fourier import analyse, l1_norm, soft_threshold, synthesise

_ITERATIONS_BETWEEN_CHECKS = 10
_NUMBERS_IN_CACHE = 50_000


class RecoveryStatus(Outcome):
    """How the recovery of a signal ended; `sentence` tells the user."""

    CONVERGED = 0, "converged"
    ITERATION_LIMIT = (
        1,
        "stopped at the iteration limit: allow more iterations or a larger tolerance, or change "
        "the splitting (0.03 to 0.3 suits most signals)",
    )
    NO_SAMPLE = 2, "no sample observed: nothing to recover from, the signal is zero"


class Recovered(NamedTuple):
    """The solved lasso of every signal of a batch (...)."""

    signal: Array
    """Phi v (..., time) at all epochs, observed or not."""
    coefficients: ComplexArray
    """v, a sparse half spectrum (..., length // 2 + 1)."""
    length: int
    """Number n of atoms."""
    objective: Array
    """Value (...) of Eq. 19; jointly, the one of all components."""
    iterations: IntArray
    """Iterations done (...)."""
    status: IntArray
    """`RecoveryStatus` (...)."""


class _Lasso(NamedTuple):
    """Problems in rows: samples (row, component, time), zero where `weight` (the paper's tau) is.

    Components of a row share their lines.
    """

    samples: Array
    weight: Array
    length: int
    penalty: float
    splitting: float

    def rows(self, index: slice | IntArray | BoolArray) -> "_Lasso":
        """Return the same of some signals."""
        return self._replace(samples=self.samples[index], weight=self.weight[index])


def basis_pursuit(
    samples: Array,
    observed: BoolArray,
    length: int,
    penalty: float,
    splitting: float = 0.03,
    iterations: int = 300,
    *,
    relaxation: float = 1.6,
    tolerance: float = 1e-3,
    start: ComplexArray | None = None,
    joint: bool = False,
) -> Recovered:
    """Recover signals `samples` (..., time) from their `observed` (..., time) epochs.

    `length` is the number n >= time of atoms (see `dictionary_length`), `penalty` the lambda of
    Eq. 19 (in the unit of the samples), `splitting` the mu of Eq. 20 divided by n. `start` has
    coefficients (..., length // 2 + 1) to start from instead of zero: those of a similar signal,
    or `analyse(guess, length) / length`. With `joint`, signals are (..., component, time) and the
    components have their lines in common.

    A signal (with `joint` all components together) is finished when v and its copy c of Eq. 20
    differ by at most `tolerance` times |s| / sqrt(n) (2-norms; the latter is about that of v),
    looked at every tenth iteration. It does not depend on the other signals of the batch. An
    observed epoch that is not finite counts as not observed.
    """
    if not (penalty > 0 and splitting > 0 and 0 < relaxation < 2):
        raise ValueError("penalty and splitting must be positive, relaxation between 0 and 2")
    if length < samples.shape[-1]:
        raise ValueError(f"{length} atoms are too few for {samples.shape[-1]} samples")
    batch = np.broadcast_shapes(samples.shape, observed.shape)[:-1]
    usable = np.broadcast_to(observed & np.isfinite(samples), (*batch, samples.shape[-1]))
    together = batch[-1] if joint else 1
    rows = (-1, together, samples.shape[-1])
    known, weight = np.where(usable, samples, 0.0), usable.astype(np.float64)
    lasso = _Lasso(known.reshape(rows), weight.reshape(rows), length, penalty, splitting)
    v = np.zeros((*batch, length // 2 + 1), complex)
    v += 0.0 if start is None else start
    v = v.reshape(-1, together, v.shape[-1])
    done, status = _solve_in_blocks(lasso, v, iterations, relaxation, tolerance)
    signal = synthesise(v, length, samples.shape[-1])
    return Recovered(
        signal=signal.reshape(*batch, -1),
        coefficients=v.reshape(*batch, -1),
        length=length,
        objective=np.repeat(_objective(lasso, v, signal), together).reshape(batch),
        iterations=np.repeat(done, together).reshape(batch),
        status=np.repeat(status, together).reshape(batch),
    )


def _solve_in_blocks(
    lasso: _Lasso, v: ComplexArray, iterations: int, relaxation: float, tolerance: float
) -> tuple[IntArray, IntArray]:
    """`_solve` for as many rows at a time as stay in the cache: 1.4 times as fast."""
    done = np.empty(len(v), np.int64)
    status = np.empty_like(done)
    size = max(1, _NUMBERS_IN_CACHE // (lasso.length * max(1, v.shape[1])))
    for begin in range(0, len(v), size):
        block = slice(begin, begin + size)
        done[block], status[block] = _solve(
            lasso.rows(block), v[block], iterations, relaxation, tolerance
        )
    return done, status


def _solve(
    lasso: _Lasso, v: ComplexArray, iterations: int, relaxation: float, tolerance: float
) -> tuple[IntArray, IntArray]:
    """Replace the start v (row, component, line) by the solution; iterations, status (row)."""
    observed = lasso.weight.any(axis=(-2, -1))
    v[~observed] = 0.0
    done = np.zeros(len(v), np.int64)
    status = np.where(observed, RecoveryStatus.ITERATION_LIMIT, RecoveryStatus.NO_SAMPLE)
    active = np.flatnonzero(observed)
    lasso, u = lasso.rows(active), v[active]
    steps = _ITERATIONS_BETWEEN_CHECKS if tolerance > 0 else iterations
    while active.size and done[active[0]] < iterations:
        steps = min(steps, iterations - done[active[0]])
        v[active], gap = _iterate(lasso, u, steps, relaxation)
        done[active] += steps
        finished = gap <= tolerance * _norm(lasso.samples) / lasso.length**0.5
        if finished.any():
            status[active[finished]] = RecoveryStatus.CONVERGED
            active, lasso, u = active[~finished], lasso.rows(~finished), u[~finished]
    return done, status


def _iterate(
    lasso: _Lasso, u: ComplexArray, iterations: int, relaxation: float
) -> tuple[ComplexArray, Array]:
    """Advance u (row, component, line) in place; v, and the norm (row) of v - c.

    With u = v + l (Eq. 23) and g = c - u = -l an iteration of Eqs. 21-27 is g = Phi*(tau (s -
    Phi u)) / (mu + n), v = soft(u + 2 g, lambda / mu), u = v - g, here relaxed to u + relaxation
    (v - u - g). The listing after Eq. 27 has the old u in its second line; the new one is meant.
    """
    length, samples = lasso.length, lasso.samples.shape[-1]
    gain = lasso.weight / ((lasso.splitting + 1.0) * length)
    threshold = lasso.penalty / (lasso.splitting * length)
    joint = u.shape[1] > 1
    residual = np.zeros((*u.shape[:-1], length))
    used = residual[..., :samples]
    for _ in range(iterations):
        np.subtract(lasso.samples, synthesise(u, length, samples), out=used)
        used *= gain
        v = analyse(residual, length)
        c = u + v
        v += c
        soft_threshold(v, threshold, out=v, joint=joint)
        np.subtract(v, c, out=c)
        c *= relaxation
        u += c
    return v, _norm(c) / relaxation


def _norm(rows: Array | ComplexArray) -> Array:
    """2-norm (row) of samples or half spectra (row, component, ...)."""
    parts = rows.view(np.float64)
    norm: Array = np.sqrt(np.sum(parts * parts, axis=(-2, -1)))
    return norm


def _objective(lasso: _Lasso, v: ComplexArray, signal: Array) -> Array:
    """Eq. 19 (row)."""
    misfit = (lasso.samples - signal) * lasso.weight
    squares: Array = 0.5 * np.sum(misfit**2, axis=(-2, -1))
    return squares + lasso.penalty * l1_norm(v, lasso.length, joint=True)
