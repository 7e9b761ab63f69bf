"""What a filter hands back: a `History`, written epoch by epoch."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.association.scan_model import ScanModel
from debrisest.filters.model import Model
from debrisest.outcome import Outcome


class FilterStatus(Outcome):
    """How a run ended: a code to store, and a sentence to show."""

    FINISHED = 0, "finished"
    DIVERGED = (
        1,
        "diverged: the state or covariance is not finite; check the initial covariance, "
        "the process noise and the measurements before this epoch",
    )
    NO_START = (
        2,
        "not started: the initial state or covariance is not finite; "
        "the start needs more or better measurements",
    )


class History(NamedTuple):
    """States after the update of every epoch; NaN from the epoch of divergence on."""

    state: Array
    """(run, time, n)."""
    sigma: Array
    """1-sigma of each error component, (run, time, n_e)."""
    covariance: Array
    """(run, kept, n_e, n_e)."""
    kept: IntArray
    """Epochs of `covariance`, ascending, the last epoch always among them."""
    nis: Array
    """Normalised innovation squared of the components used, (run, time)."""
    nis_dof: IntArray
    """Number of components used, (run, time)."""
    repairs: IntArray
    """How often a covariance without a Cholesky factor was repaired, (run,)."""
    status: IntArray
    """`FilterStatus` codes, (run,)."""
    diverged_at: IntArray
    """Epoch of divergence, -1 if none, (run,)."""
    iterations: IntArray
    """Linearisations of the update, 1 where the filter does not iterate, (run, time)."""
    rejected: IntArray
    """Number of measured components that a gate kept out, (run, time)."""
    reopened: IntArray
    """How often a gate that had locked the run out was opened, (run,)."""
    validated: IntArray
    """Number of unlabelled detections that gates let through, (run, time)."""


class Tally(NamedTuple):
    """What an update may count beside its result, each (run,)."""

    iterations: IntArray
    rejected: IntArray
    reopened: IntArray
    validated: IntArray | int = 0


class HistoryWriter:
    """Collects a `History` epoch by epoch and takes diverged runs out of the computation.

    A diverged run keeps its place in the batch, with its (finite) start as a stand-in, so that the
    arithmetic of the other runs does not change in a single bit.
    """

    def __init__(
        self,
        model: Model | ScanModel,
        state: Array,
        covariance: Array,
        epochs: int,
        keep: Sequence[int] = (),
    ):
        _require_shapes(model, state, covariance, epochs, keep)
        runs, n = state.shape
        n_e = covariance.shape[-1]
        kept = sorted({*keep, epochs - 1})
        self._slot = {epoch: slot for slot, epoch in enumerate(kept)}
        self._placeholder = np.nan_to_num(state, nan=0.0, posinf=0.0, neginf=0.0)
        self._alive = _finite(state, covariance)
        self._history = History(
            state=np.empty((runs, epochs, n)),
            sigma=np.empty((runs, epochs, n_e)),
            covariance=np.empty((runs, len(kept), n_e, n_e)),
            kept=np.array(kept, dtype=np.int64),
            nis=np.empty((runs, epochs)),
            nis_dof=np.empty((runs, epochs), dtype=np.int64),
            repairs=np.zeros(runs, dtype=np.int64),
            status=np.where(self._alive, FilterStatus.FINISHED, FilterStatus.NO_START),
            diverged_at=np.where(self._alive, -1, 0),
            iterations=np.ones((runs, epochs), dtype=np.int64),
            rejected=np.zeros((runs, epochs), dtype=np.int64),
            reopened=np.zeros(runs, dtype=np.int64),
            validated=np.zeros((runs, epochs), dtype=np.int64),
        )

    @property
    def alive(self) -> BoolArray:
        """Runs that have not diverged yet, (run,)."""
        return self._alive

    def live(self, state: Array, covariance: Array) -> tuple[Array, Array]:
        """State and covariance to compute with: those of diverged runs replaced."""
        if self._alive.all():
            return state, covariance
        return (
            np.where(self._alive[:, None], state, self._placeholder),
            np.where(self._alive[:, None, None], covariance, np.eye(covariance.shape[-1])),
        )

    def record(
        self,
        k: int,
        state: Array,
        covariance: Array,
        nis: Array,
        dof: IntArray,
        repairs: IntArray,
        tally: Tally | None = None,
    ) -> None:
        """Store the posterior of epoch k, and find the runs that have diverged."""
        if not np.isfinite(state.sum() + covariance.sum()):
            self._diverge(k, _finite(state, covariance))
        history = self._history
        history.state[:, k] = state
        history.sigma[:, k] = np.sqrt(np.maximum(np.diagonal(covariance, 0, -2, -1), 0.0))
        history.nis[:, k] = nis
        history.nis_dof[:, k] = dof
        history.repairs[self._alive] += repairs[self._alive]
        if tally is not None:
            history.iterations[:, k] = tally.iterations
            history.rejected[:, k] = tally.rejected
            history.validated[:, k] = tally.validated
            history.reopened[self._alive] += tally.reopened[self._alive]
        if k in self._slot:
            history.covariance[:, self._slot[k]] = covariance

    def history(self) -> History:
        """Everything recorded, and NaN where a run had diverged."""
        history = self._history
        start = history.diverged_at[:, None]
        lost = (start >= 0) & (np.arange(history.state.shape[1]) >= start)
        for values in (history.state, history.sigma, history.nis):
            values[lost] = np.nan
        for counts in (history.nis_dof, history.iterations, history.rejected, history.validated):
            counts[lost] = 0
        history.covariance[lost[:, history.kept]] = np.nan
        return history

    def _diverge(self, k: int, finite: BoolArray) -> None:
        failed = self._alive & ~finite
        self._history.status[failed] = FilterStatus.DIVERGED
        self._history.diverged_at[failed] = k
        self._alive[~finite] = False


def _finite(state: Array, covariance: Array) -> BoolArray:
    return np.asarray(np.isfinite(state).all(-1) & np.isfinite(covariance).all((-2, -1)))


def _require_shapes(
    model: Model | ScanModel, state: Array, covariance: Array, epochs: int, keep: Sequence[int]
) -> None:
    runs, n_e = state.shape[0], len(model.error_names)
    if covariance.shape != (runs, n_e, n_e) or model.process_noise.shape != (n_e, n_e):
        raise ValueError(
            f"{runs} runs with {n_e} error names need a start covariance of shape "
            f"({runs}, {n_e}, {n_e}) and process noise of shape ({n_e}, {n_e}), "
            f"not {covariance.shape} and {model.process_noise.shape}"
        )
    if epochs < 1 or not all(0 <= epoch < epochs for epoch in keep):
        raise ValueError(f"the kept epochs must lie within the {epochs} measured ones")
