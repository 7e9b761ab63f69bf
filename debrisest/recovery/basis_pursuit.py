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
from debrisest.recovery.fourier import l1_norm, synthesise
from debrisest.recovery.salsa import Effort, Lasso, solve


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
    single: bool = False,
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

    A tolerance is sought in single precision, which takes half the time, down to 1e-4, and beyond
    it in double; without one all iterations are in double precision. With `single` all are in
    single, and so are the coefficients: enough to compare hypotheses.
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
    lasso = Lasso(known.reshape(rows), weight.reshape(rows), length, penalty, splitting)
    v = np.zeros((*batch, length // 2 + 1), np.complex64 if single else np.complex128)
    v += 0.0 if start is None else start
    v = v.reshape(-1, together, v.shape[-1])
    lasso = lasso.in_precision(np.float32) if single else lasso
    done, status = _solved(lasso, v, Effort(iterations, relaxation, tolerance))
    signal = synthesise(v, length, samples.shape[-1])
    return Recovered(
        signal=signal.reshape(*batch, -1),
        coefficients=v.reshape(*batch, -1),
        length=length,
        objective=np.repeat(_objective(lasso, v, signal), together).reshape(batch),
        iterations=np.repeat(done, together).reshape(batch),
        status=np.repeat(status, together).reshape(batch),
    )


def _solved(lasso: Lasso, v: ComplexArray, effort: Effort) -> tuple[IntArray, IntArray]:
    """Replace starts v (row, component, line) by solutions; iterations and status (row)."""
    seen = np.asarray(lasso.weight.any(axis=(-2, -1)))
    done = np.zeros(len(v), np.int64)
    status = np.full(len(v), int(RecoveryStatus.NO_SAMPLE))
    found = v[seen]
    done[seen], met = solve(lasso.rows(seen), found, effort)
    v[seen], v[~seen] = found, 0.0
    limit, converged = int(RecoveryStatus.ITERATION_LIMIT), int(RecoveryStatus.CONVERGED)
    status[seen] = np.where(met, converged, limit)
    return done, status


def _objective(lasso: Lasso, v: ComplexArray, signal: Array) -> Array:
    """Eq. 19 (row)."""
    misfit = (lasso.samples - signal) * lasso.weight
    squares = np.asarray(np.sum(misfit**2, axis=(-2, -1), dtype=np.float64))
    return 0.5 * squares + lasso.penalty * l1_norm(v, lasso.length, joint=True)
