"""What is the same in every run, or in every run of the same body."""

from collections.abc import Callable

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.draws import Draws


def each_run(values: dict[str, Array], draws: Draws) -> Data:
    """Return values of one run as those of every run, the first axis, without copies."""
    runs = len(draws.runs)
    return {name: np.broadcast_to(value, (runs, *value.shape)) for name, value in values.items()}


def each_body(rotation: Callable[[Array], dict[str, Array]], inertia: Array) -> Data:
    """Return rotations (run, ...), each computed once, of bodies of inertia (run, 3, 3)."""
    bodies, of_run = np.unique(inertia, axis=0, return_inverse=True)
    rotations = [rotation(body) for body in bodies]
    if len(bodies) == 1:
        return {n: np.broadcast_to(v, (len(of_run), *v.shape)) for n, v in rotations[0].items()}
    return {name: np.array([rotations[k][name] for k in of_run.ravel()]) for name in rotations[0]}
