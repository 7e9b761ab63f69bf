"""The recursion of the association filters by compiled loops, all runs of an epoch in one call."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.filters.association.evidence import Evidence, nothing_yet
from debrisest.filters.association.restless import Bank, mixed
from debrisest.filters.association.weighing import Weighing
from debrisest.filters.estimates import Estimates, EstimatesWriter
from debrisest.filters.scan_model import ScanModel

if TYPE_CHECKING:
    from debrisest.filters.association.recursion import AssociationSettings

_LANES = 32
"""Runs of a block: their covariances stay in the cache."""
FIGURES = (
    *("nis", "nis_dof", "rejected", "validated", "looked"),
    *("matched", "mistaken", "near", "ring"),
)


def filtered(
    model: ScanModel,
    state: Array,
    covariance: Array,
    scans: Array,
    settings: "AssociationSettings",
    keep: Sequence[int],
) -> Estimates:
    """Return what `recursion.filtered` does, where points have two components, one by one."""
    from debrisest.filters.association import recursion_loops

    assert isinstance(settings.weigh, Weighing)
    runs, epochs = scans.shape[:2]
    start, counts = (state[:, 0], covariance[:, 0]), dict.fromkeys(FIGURES[2:], 0.0)
    writer = EstimatesWriter(model.error_names, *start, epochs, keep, counts, totals=["repairs"])
    beside, evidence = nothing_yet(model, *start)
    apart, bank = np.swapaxes(beside.bank.apart, 1, 2), beside.bank.covariance
    recursive: Any = tuple(map(_blocks, (state, covariance, beside.pull, apart, bank)))
    sums: Any = tuple(map(_blocks, evidence))
    told = state.copy(), covariance[:, 0].copy(), np.empty((len(FIGURES), runs))
    before, nominal = np.full((runs, *scans.shape[2:]), np.nan), _whole(state)
    noise = _whole(model.process_noise)
    fixed = _whole(model.noise), float(settings.gate), *settings.weigh.numbers
    with np.errstate(all="ignore"):
        for k in range(epochs):
            if k > 0:
                moved, transition = map(_whole, model.moved(nominal, k - 1))
                recursion_loops.predict(moved, transition, nominal, noise, recursive)
                nominal = moved
            if settings.truth is not None:
                nominal = _whole(settings.truth[:, None, k])
            given: Any = nominal, *map(_whole, model.seen(nominal, k))
            recursion_loops.look(_whole(scans[:, k]), before, given, fixed, recursive, sums, told)
            if settings.relinearise > 0 and (k + 1) % settings.relinearise == 0:
                nominal = told[0].copy()
            mean, spread = told[0][:, 0], told[1]
            if settings.restless:
                apart, bank = (_runs(part, runs) for part in recursive[3:])
                both = Bank(np.swapaxes(apart, 1, 2), bank)
                mean, spread = mixed(both, _runs(sums[3], runs), mean)
            going = writer.runs
            figures: Data = {name: part[going] for name, part in zip(FIGURES, told[2])}
            writer.record(k, mean[going], spread[going], figures)
    found = writer.estimates()
    whole = Evidence(*(_runs(part, runs) for part in sums))
    return found._replace(counts=found.counts | whole._asdict())


def _whole(values: Array) -> Array:
    """Return an array as the loops want all of them: in one piece, and not a view of less."""
    return np.require(values, np.float64, ["C", "W"])


def _blocks(values: Array) -> Array:
    """Return values (run, ...) in blocks (block, ..., run of it), the last run repeated."""
    count = -(-len(values) // _LANES)
    padded = values[np.minimum(np.arange(count * _LANES), len(values) - 1)]
    by_block = padded.reshape(count, _LANES, *values.shape[1:])
    return np.ascontiguousarray(np.moveaxis(by_block, 1, -1))


def _runs(blocks: Array, count: int) -> Array:
    """Return the values (run, ...) of so many runs in blocks."""
    by_block = np.moveaxis(blocks, -1, 1)
    return by_block.reshape(len(blocks) * _LANES, *by_block.shape[2:])[:count]
