"""Estimated quantities with their standard deviations, from the files of any filter, in rows."""

from collections.abc import Collection, Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from debrisest.arrays import Data
from debrisest.errors import UserError
from debrisest.files import replacing
from debrisest.filters.verdict import Verdict
from debrisest.results.results import Results
from debrisest.vocabulary import VOCABULARY, shown_unit, table_scale

OF_ROW = ("time_s", "quantity", "component", "value", "sigma", "unit")
COLUMNS = ("case", "estimator", "run", *OF_ROW)
_OF_RUN = ("run", "time_s", "status", "failure", "doubt", "doubt_at")


class Estimate(NamedTuple):
    """What an estimator knows of a run at one epoch."""

    case: str
    estimator: str
    run: int
    time: float
    """Of the epoch, s."""
    status: str
    """What is said of the estimate, how the filter ended, or why the run gave no result."""
    rows: pd.DataFrame
    """With the columns `OF_ROW`; empty where the run failed."""


def estimates_at(results: Results, run: int = 0, time: float = np.inf) -> Iterator[Estimate]:
    """Yield what all estimators know of a run at the last epoch that is not after ``time``, s.

    An estimator without this run is left out. Raises UserError where there is no such epoch, or
    the run's trajectories are not kept.
    """
    for case, estimator in _filtered(results):
        data = results.load(case, estimator, "filter", _names(), run + 1)
        there = np.flatnonzero(data["run"] == run)
        if not len(there):
            continue
        index, times = int(there[0]), data["time_s"]
        epoch = int(np.searchsorted(times, time, side="right")) - 1
        if epoch < 0:
            raise UserError(f"--at {time:g}: the first epoch is at {times[0]:g} s")
        if epoch < len(times) - 1 and not results.is_whole(case, estimator, run):
            raise UserError(f"--at {time:g}: {results.not_kept(case, estimator, run)}")
        failure = str(data["failure"][index])
        rows = _of_run(data, index, _features(results, case), slice(epoch, epoch + 1))
        status = f"failed: {failure}" if failure else _said(data, index, epoch)
        shown = rows.iloc[:0] if failure else rows
        yield Estimate(case, estimator, run, float(times[epoch]), status, shown)


def _said(data: Data, run: int, epoch: int) -> str:
    """Return the run's status, and the word for an epoch on the way that it trusts less."""
    status = str(data["status"][run])
    if "doubt_at" not in data or not data["doubt_at"][run, epoch] > data["doubt"][run]:
        return status
    word = list(Verdict)[int(data["doubt_at"][run, epoch])].sentence
    return f"{word}, by what is known at the end; there: {status}"


def export(results: Results, path: Path) -> int:
    """Write all epochs of all runs as CSV with `COLUMNS`; return the number of rows.

    Units are those of the tables. What does not change with time has no ``time_s``; what is not
    known has no ``value``; runs that failed are left out. Of runs whose trajectories are not kept
    there is the last epoch.
    """
    written = 0
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        file.write(",".join(COLUMNS) + "\n")
        for rows in _all_rows(results):
            rows.to_csv(file, header=False, index=False, lineterminator="\n")
            written += len(rows)
    return written


def _all_rows(results: Results) -> Iterator[pd.DataFrame]:
    """Yield the rows of one run after the other, reading file by file."""
    for case, estimator in _filtered(results):
        features = _features(results, case)
        for chunk in results.chunks:
            if chunk.address[1:4] != (case, "filter", estimator):
                continue
            data = chunk.read(_names())
            for index in np.flatnonzero(data["failure"] == ""):
                epochs = slice(0 if chunk.is_whole(int(index)) else -1, None)
                rows = _of_run(data, int(index), features, epochs)
                rows.insert(0, "run", int(data["run"][index]))
                rows.insert(0, "estimator", estimator)
                rows.insert(0, "case", case)
                yield rows


def _filtered(results: Results) -> Iterator[tuple[str, str]]:
    """Yield the cases and estimators that have a filter's file."""
    for case in results.cases:
        for estimator in results.estimators(case):
            if "filter" in results.stages(case, estimator):
                yield case, estimator


def _names() -> Collection[str]:
    """Return what is read of a filter's file, plug-ins' quantities among it."""
    estimated = [name for name in VOCABULARY if f"{name}_sigma" in VOCABULARY]
    return {*_OF_RUN, *estimated, *(f"{name}_sigma" for name in estimated)}


def _features(results: Results, case: str) -> list[str]:
    """Return the names of the features, as far as the simulation or the data have some."""
    names = results.load(case, names=("feature",)) if results.stages(case) else {}
    return [str(name) for name in names.get("feature", [])]


def _of_run(
    data: Data, run: int, features: Sequence[str], epochs: slice = slice(None)
) -> pd.DataFrame:
    """Return the rows of the run of this index, with the columns `OF_ROW`."""
    names = [name for name in data if f"{name}_sigma" in data]
    parts = [_of_quantity(name, data, run, features, epochs) for name in names]
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=[*OF_ROW])


def _of_quantity(
    name: str, data: Data, run: int, features: Sequence[str], epochs: slice
) -> pd.DataFrame:
    value, sigma = data[name][run], data[f"{name}_sigma"][run]
    axes, times = VOCABULARY[name].axes[1:], np.array([np.nan])
    if axes[:1] == ("time_s",):
        value, sigma, times, axes = value[epochs], sigma[epochs], data["time_s"][epochs], axes[1:]
    else:
        value, sigma = value[None], sigma[None]
    labels = _components(axes, value.shape[1:], features)
    scale = table_scale(name, shown_unit(name))
    columns = (
        np.repeat(times, len(labels)),
        name,
        np.tile(labels, len(times)),
        scale * value.ravel(),
        scale * sigma.ravel(),
        shown_unit(name),
    )
    return pd.DataFrame(dict(zip(OF_ROW, columns)))


def _components(axes: Sequence[str], shape: Sequence[int], features: Sequence[str]) -> list[str]:
    """Return what the components are called: features by name, quaternions from 0, else from 1."""
    of_axis: list[list[str]] = []
    for axis, length in zip(axes, shape):
        first = 0 if axis == "quaternion" else 1
        numbers = [str(first + index) for index in range(length)]
        of_axis.append(list(features) if axis == "feature" and len(features) == length else numbers)
    return [" ".join(labels) for labels in product(*of_axis)]
