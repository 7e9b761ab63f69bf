"""Random draws that belong to a run, whatever is computed together with it, and in which order."""

import zlib
from collections.abc import Sequence
from enum import IntEnum

import numpy as np

from debrisest.arrays import Array, Data


class Stream(IntEnum):
    """Independent streams of one run."""

    TRUTH = 0
    MEASUREMENT_NOISE = 1
    CLUTTER = 2
    INITIAL_ERROR = 3


def case_key(case: str) -> int:
    """Return the part of a run's seed that tells a case from the others of its scenario."""
    return zlib.crc32(case.encode())


class Draws:
    """Draws for a batch of runs; the batch is the first axis of everything that is returned.

    Each run has its own generator for each stream, seeded by the scenario's seed, the case's
    name, the run's number and the stream, so that a run's draws never depend on its companions.
    """

    def __init__(self, seed: int, case: str, runs: Sequence[int]) -> None:
        self.runs = list(runs)
        self._entropy = (seed, case_key(case))
        self._generators: dict[Stream, list[np.random.Generator]] = {}

    def normal(self, stream: Stream, shape: tuple[int, ...]) -> Array:
        """Return standard normal draws (run, *shape)."""
        return np.stack([g.standard_normal(shape) for g in self._of(stream)])

    def uniform(self, stream: Stream, shape: tuple[int, ...]) -> Array:
        """Return draws spread evenly over [0, 1) (run, *shape)."""
        return np.stack([g.random(shape) for g in self._of(stream)])

    def _of(self, stream: Stream) -> list[np.random.Generator]:
        if stream not in self._generators:
            seed, case = self._entropy
            self._generators[stream] = [
                np.random.default_rng(
                    np.random.SeedSequence(seed, spawn_key=(case, run, int(stream)))
                )
                for run in self.runs
            ]
        return self._generators[stream]


def drawn_about(name: str, true: Array, sigma: Array | float, draws: Draws) -> Data:
    """Return a first guess of ``true`` (run, ...) and its sigma (...), by name."""
    noise = draws.normal(Stream.INITIAL_ERROR, true.shape[1:])
    return {name: true + sigma * noise, f"{name}_sigma": np.full(true.shape, sigma)}
