"""What the replay filter hands back: `Estimates`, written epoch by epoch."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.outcome import Outcome


class ReplayStatus(Outcome):
    """How a run ended: a code to store, and a sentence to show."""

    CONVERGED = 0, "converged"
    DIVERGED = (
        1,
        "diverged: the state or its information is not finite; check the prior covariance and the "
        "measurements before this epoch",
    )
    NO_START = (
        2,
        "not started: the prior is not finite; the start needs more or better measurements",
    )
    NOT_CONVERGED = (
        3,
        "not converged: the last replay still promised a decrease of the cost when it was stopped; "
        "more iterations or a better start are needed",
    )


class Estimates(NamedTuple):
    """Estimates of every epoch; NaN from the epoch of divergence on."""

    state: Array
    """(run, time, n)."""
    sigma: Array
    """1-sigma of each plain error, (run, time, n_e)."""
    covariance: Array
    """Of the plain errors, (run, kept, n_e, n_e)."""
    kept: IntArray
    """Epochs of `covariance`, ascending, the last epoch always among them."""
    nis: Array
    """Normalised innovation squared, (run, time)."""
    nis_dof: IntArray
    """Number of rows that were used, (run, time)."""
    rejected: IntArray
    """Number of rows that the gate kept out at the time, (run, time)."""
    cost: Array
    """Cost of the estimate at anchors and kept epochs, (run, time), NaN at the others."""
    cost_beside: Array
    """Cost, by the same measurements, of a motion beside the estimate, at the kept epochs."""
    status: IntArray
    """`ReplayStatus` codes, (run,)."""
    diverged_at: IntArray
    """Epoch of divergence, -1 if none, (run,)."""


def empty(shape: tuple[int, int, int], n_e: int, keep: Sequence[int]) -> Estimates:
    """Return estimates of (run, time, n) that have yet to be written."""
    runs, epochs, n = shape
    kept = sorted({*keep, epochs - 1})
    if not (epochs > 0 and kept[0] >= 0 and kept[-1] < epochs):
        raise ValueError(f"the kept epochs must lie within the {epochs} measured ones")
    return Estimates(
        state=np.full((runs, epochs, n), np.nan),
        sigma=np.full((runs, epochs, n_e), np.nan),
        covariance=np.full((runs, len(kept), n_e, n_e), np.nan),
        kept=np.array(kept, dtype=np.int64),
        nis=np.full((runs, epochs), np.nan),
        nis_dof=np.zeros((runs, epochs), dtype=np.int64),
        rejected=np.zeros((runs, epochs), dtype=np.int64),
        cost=np.full((runs, epochs), np.nan),
        cost_beside=np.full((runs, epochs), np.nan),
        status=np.full(runs, ReplayStatus.NO_START, dtype=np.int64),
        diverged_at=np.zeros(runs, dtype=np.int64),
    )


def write(
    estimates: Estimates, epoch: int, runs: IntArray, state: Array, covariance: Array
) -> None:
    """Write the estimate of some runs, with the covariance of their plain errors."""
    estimates.state[runs, epoch] = state
    estimates.sigma[runs, epoch] = np.sqrt(np.diagonal(covariance, 0, -2, -1))
    for slot in np.flatnonzero(estimates.kept == epoch):
        estimates.covariance[runs, slot] = covariance


def finite(state: Array, matrix: Array) -> BoolArray:
    """Return the runs whose state and matrix are finite."""
    return np.asarray(np.isfinite(state).all(-1) & np.isfinite(matrix).all((-2, -1)))
