"""Parts of a time step in which a fast rotation turns little, each run divided by its own rate."""

from collections.abc import Iterator

import numpy as np

from debrisest.arrays import Array, IntArray

LARGEST_TURN = 0.1
"""rad. The error of a classical Runge-Kutta step is below 1e-7 rad then, and grows as its fifth
power: a step of 0.5 rad is off by 3e-4 rad, more than what cameras show."""
MOST = 100
"""Who turns by more than 10 rad from one epoch to the next cannot be followed anyway."""


def substeps(speed: Array, step: float) -> IntArray:
    """Return the number of parts of a step, s, for each ``speed (...)``, rad/s, of any sign."""
    with np.errstate(invalid="ignore", over="ignore"):
        count = np.ceil(np.abs(speed * step) / LARGEST_TURN)
    return np.asarray(np.minimum(np.fmax(count, 1.0), MOST), dtype=np.int64)


def parts(step: float, count: IntArray) -> Iterator[tuple[int, float | Array]]:
    """Number the parts of a step, each with its lengths (...): zero for who is at the end already.

    Where nothing is divided the one part is the ``step`` itself. What a run gets does not depend on
    the others.
    """
    most = int(count.max(initial=1))
    if most == 1:
        yield 0, step
        return
    for i in range(most):
        yield i, np.where(i < count, step / count, 0.0)
