"""What every filter hands back: `Estimates`, written epoch by epoch."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray, Data, IntArray
from debrisest.filters.status import FilterStatus
from debrisest.outcome import Outcome, sentences


class Estimates(NamedTuple):
    """States after the update of every epoch; NaN from the epoch of divergence on."""

    state: Array
    """(run, time, n)."""
    sigma: Array
    """1-sigma of each error, (run, time, n_e)."""
    covariance: Array
    """(run, kept, n_e, n_e)."""
    kept: IntArray
    """Epochs of `covariance`, ascending, the last epoch always among them."""
    nis: Array
    """Normalised innovation squared of the components used, (run, time)."""
    nis_dof: IntArray
    """Number of components used, (run, time)."""
    status: NDArray[np.str_]
    """How each run ended, in words, (run,)."""
    counts: Data = {}
    """What else the filter counts, by its name in the vocabulary."""

    @property
    def diverged_at(self) -> IntArray:
        """Epoch of divergence, -1 if none, (run,)."""
        lost: BoolArray = np.asarray(np.isnan(self.sigma).all(-1))
        return np.where(lost.any(1), lost.argmax(1), -1)


def joined(groups: Sequence[IntArray], found: Sequence[Estimates]) -> Estimates:
    """Return the estimates of groups of runs, each found by itself, as those of one batch."""
    order = np.argsort(np.concatenate(groups))

    def whole(parts: Iterable[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate(list(parts))[order]

    return Estimates(
        state=whole(one.state for one in found),
        sigma=whole(one.sigma for one in found),
        covariance=whole(one.covariance for one in found),
        kept=found[0].kept,
        nis=whole(one.nis for one in found),
        nis_dof=whole(one.nis_dof for one in found),
        status=whole(one.status for one in found),
        counts={name: whole(one.counts[name] for one in found) for name in found[0].counts},
    )


class EstimatesWriter:
    """Collects `Estimates` epoch by epoch and tells which runs go on.

    A run that is not finite leaves the batch, which from then on is that of `runs`: filter and
    model take them out (`of`), so that the others' arithmetic does not change in a single bit.

    `counts` names what is counted at every epoch, each with what stands for nothing (0 or NaN),
    `totals` what is summed over the epochs.
    """

    def __init__(
        self,
        error_names: Sequence[str],
        state: Array,
        covariance: Array,
        epochs: int,
        keep: Sequence[int] = (),
        counts: Mapping[str, float] = {},
        totals: Sequence[str] = (),
        outcomes: type[Outcome] = FilterStatus,
    ):
        """Begin with ``state (run, n)`` and ``covariance``, or information, (run, n_e, n_e)."""
        (runs, n), n_e = state.shape, len(error_names)
        _require_shapes(covariance, (runs, n_e, n_e), epochs, keep)
        kept = np.array(sorted({*keep, epochs - 1}), dtype=np.int64)
        sound = finite(state, covariance)
        self.runs: IntArray = np.flatnonzero(sound)
        """Runs that have not diverged yet."""
        self._outcomes = outcomes
        self._status = np.where(sound, FilterStatus.FINISHED, FilterStatus.NO_START)
        self._state = np.full((runs, epochs, n), np.nan)
        self._sigma = np.full((runs, epochs, n_e), np.nan)
        self._covariance = np.full((runs, len(kept), n_e, n_e), np.nan)
        self._kept = kept
        blank = {"nis": np.nan, "nis_dof": 0, **counts}
        self._counts: Data = {
            name: np.full((runs, epochs), nothing) for name, nothing in blank.items()
        }
        self._counts |= {name: np.zeros(runs, dtype=np.int64) for name in totals}

    def keeps(self, k: int) -> bool:
        """Return whether the covariance of epoch k is kept."""
        return k in self._kept

    def record(
        self, k: int, state: Array, covariance: Array, figures: Data, shown: Array | None = None
    ) -> IntArray:
        """Store the posterior of epoch k of the whole batch; return its members that go on.

        Where no covariance is kept, variances ``(run, n_e)`` are enough.
        `shown` is what to store in place of the state, where parts of it are not to be shown.
        """
        sound, stored = finite(state, covariance), state if shown is None else shown
        going = np.flatnonzero(sound)
        if len(going) < len(sound):
            self._status[self.runs[~sound]] = FilterStatus.DIVERGED
            self.runs = self.runs[going]
            stored, covariance = stored[going], covariance[going]
            figures = {name: values[going] for name, values in figures.items()}
        self.write(k, stored, covariance)
        self.count(k, figures)
        return going

    def write(self, k: int, state: Array, covariance: Array) -> None:
        """Store state and covariance of the batch, whatever they are."""
        self._state[self.runs, k] = state
        variance = covariance if covariance.ndim == 2 else np.diagonal(covariance, 0, -2, -1)
        self._sigma[self.runs, k] = np.sqrt(np.maximum(variance, 0.0))
        for slot in np.flatnonzero(self._kept == k):
            self._covariance[self.runs, slot] = covariance

    def count(self, k: int, figures: Data) -> None:
        """Store figures (run,) of the batch, as far as they are wanted."""
        for name in figures.keys() & self._counts.keys():
            if self._counts[name].ndim == 1:
                self._counts[name][self.runs] += figures[name]
            else:
                self._counts[name][self.runs, k] = figures[name]

    def conclude(self, status: IntArray | Outcome) -> None:
        """Set how the runs of the batch ended, should they not diverge."""
        self._status[self.runs] = status

    def estimates(self) -> Estimates:
        """Return everything recorded."""
        counts = dict(self._counts)
        return Estimates(
            *(self._state, self._sigma, self._covariance, self._kept),
            *(counts.pop("nis"), counts.pop("nis_dof")),
            status=sentences(self._status, self._outcomes),
            counts=counts,
        )


def finite(state: Array, matrix: Array) -> BoolArray:
    """Return the runs whose state and matrix are finite."""
    axes = tuple(range(1, matrix.ndim))
    return np.asarray(np.isfinite(state).all(-1) & np.isfinite(matrix).all(axes))


def _require_shapes(
    covariance: Array, wanted: tuple[int, int, int], epochs: int, keep: Sequence[int]
) -> None:
    if covariance.shape != wanted:
        raise ValueError(
            f"{wanted[0]} runs with {wanted[1]} error names need a start covariance of shape "
            f"{wanted}, not {covariance.shape}"
        )
    if epochs < 1 or not all(0 <= epoch < epochs for epoch in keep):
        raise ValueError(f"the kept epochs must lie within the {epochs} measured ones")
