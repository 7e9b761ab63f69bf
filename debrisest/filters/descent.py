"""Damped descent on the costs of a batch of runs, which stop one by one."""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.runs import put, take

Point = TypeVar("Point", bound=tuple[Any, ...])
"""Arrays with the run first: a place, and the cost linearised there."""


class Damping(NamedTuple):
    """How steps are damped, and when they end, by arrays (run,)."""

    first: float
    following: Callable[[Array, BoolArray], Array]
    """(damping, whether the step has lowered the cost) -> that of the next step."""
    done: Callable[[Array, Array, Array], BoolArray]
    """(decrease that the last step promised, that the next one does, damping) -> ends here."""


def descend(
    best: Point,
    cost: Callable[[Point], Array],
    step: Callable[[Point, IntArray, Array], tuple[Array, Array]],
    trial: Callable[[Point, IntArray, Array], Point],
    damping: Damping,
    iterations: int,
) -> tuple[Point, Array, Array]:
    """Lower the `cost` (run,) of every run, in place, each with a damping of its own.

    `step` gives of points of some runs, with their damping, the next step (run, n) and the decrease
    of the cost that it promises; `trial`, of the whole batch, the points of some runs after theirs.
    A step that raises the cost is taken back. `iterations` counts linearisations, the first point
    is one. Returns where it ended, and the step and the promise from there. A run whose first cost
    is not finite stays where it is.
    """
    runs = np.arange(len(cost(best)))
    strength = np.full(len(runs), damping.first)
    with np.errstate(all="ignore"):
        steps, promise = step(best, runs, strength)
        never = np.full(len(runs), np.inf)
        active = np.isfinite(cost(best)) & ~damping.done(never, promise, strength)
        for _ in range(iterations - 1):
            runs = np.flatnonzero(active)
            if len(runs) == 0:
                break
            new = trial(best, runs, steps[runs])
            better = cost(new) <= cost(best)[runs]
            put(best, runs[better], take(new, np.flatnonzero(better)))
            strength[runs] = damping.following(strength[runs], better)
            before = promise[runs]
            steps[runs], promise[runs] = step(take(best, runs), runs, strength[runs])
            active[runs] = ~damping.done(before, promise[runs], strength[runs])
    return best, steps, promise
