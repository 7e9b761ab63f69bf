"""Some runs of named tuples of arrays, which may hold such tuples themselves."""

from typing import Any, TypeVar

from debrisest.arrays import IntArray

Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


def take(arrays: Arrays, runs: IntArray) -> Arrays:
    """Return some runs of all the arrays."""
    return type(arrays)(
        *(take(part, runs) if isinstance(part, tuple) else part[runs] for part in arrays)
    )


def put(arrays: Arrays, runs: IntArray, new: Arrays) -> None:
    """Replace some runs of all the arrays, in place."""
    for part, values in zip(arrays, new):
        if isinstance(part, tuple):
            put(part, runs, values)
        else:
            part[runs] = values
