"""One bad run never takes the others down."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arithmetic import strict
from debrisest.arrays import Data
from debrisest.runner.stages.reason import reason
from debrisest.vocabulary import has_runs

MACHINE_FAILURES = (MemoryError, OSError, ImportError)
"""What is no fault of a run: the step is not finished, and is tried again next time.

Libraries are loaded when they are needed, which fails where there is no memory for them.
"""


@strict()
def isolate(compute: Callable[[Data], Data], data: Data) -> Data:
    """Return ``compute(data)`` for all runs together, or run by run where that fails.

    A run that raises gets NaN in every dataset and its reason in ``failure``; so does a run that
    had failed before. The result keeps ``run``.
    """
    runs = len(data["run"])
    failure = list(data.get("failure", [""] * runs))
    good = np.array([not reason for reason in failure], dtype=bool)
    results: list[tuple[NDArray[np.intp], Data]] = []
    everyone = np.flatnonzero(good)
    if len(everyone):
        try:
            results = [(everyone, compute(_take(data, everyone)))]
        except MACHINE_FAILURES:
            raise
        except Exception:
            for run in everyone:
                try:
                    results.append((np.array([run]), compute(_take(data, np.array([run])))))
                except MACHINE_FAILURES:
                    raise
                except Exception as error:
                    failure[run] = reason(error)
    result = _scatter(results, runs) if results else {}
    return {**result, "run": data["run"], "failure": np.array(failure)}


def _take(data: Data, runs: NDArray[np.intp]) -> Data:
    return {name: value[runs] if has_runs(name) else value for name, value in data.items()}


def _scatter(results: list[tuple[NDArray[np.intp], Data]], runs: int) -> Data:
    whole: Data = {}
    for name, first in results[0][1].items():
        if not has_runs(name) or len(results[0][0]) == runs:
            whole[name] = first
            continue
        values: list[Any] = [result[name] for _, result in results]
        shape = np.max([value.shape[1:] for value in values], axis=0)
        is_text = first.dtype.kind in "US"
        whole[name] = np.full(
            (runs, *shape), "" if is_text else np.nan, object if is_text else None
        )
        for (where, _), value in zip(results, values):
            inner: list[Any] = [slice(length) for length in value.shape[1:]]
            whole[name][(where, *inner)] = value
        if is_text:
            whole[name] = whole[name].astype(str)
    return whole
