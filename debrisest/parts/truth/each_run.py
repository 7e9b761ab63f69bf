"""What is the same in every run."""

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.draws import Draws


def each_run(values: dict[str, Array], draws: Draws) -> Data:
    """Return values of one run as those of every run, the first axis, without copies."""
    runs = len(draws.runs)
    return {name: np.broadcast_to(value, (runs, *value.shape)) for name, value in values.items()}
