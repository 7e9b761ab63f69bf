"""What the first steps of a search for signs tried (Biondi et al. 2017, Figs. 5-7)."""

import numpy as np

from debrisest.arrays import Array, IntArray


class Hypotheses:
    """Keeps the hypotheses that a search tries, in its order, until ``most`` are kept for a run.

    What a run lacks is NaN.
    """

    def __init__(self, runs: int, most: int, pieces: int, epochs: int) -> None:
        self.sign = np.full((runs, most, pieces), np.nan)
        """Signs (run, hypothesis, piece); NaN for the pieces that it says nothing of."""
        self.score = np.full((runs, most), np.nan)
        """Penalties (run, hypothesis)."""
        self.signal = np.full((runs, most, epochs), np.nan)
        """Recovered signals (run, hypothesis, time), up to the end of the last piece."""

    def __call__(self, runs: IntArray, sign: Array, signal: Array, score: Array) -> None:
        """Keep what was tried for ``runs``, all of whom have as many hypotheses so far."""
        most = self.score.shape[1]
        begin = int(np.isfinite(self.score[runs[0]]).sum())
        end = min(begin + score.shape[1], most)
        tried = slice(begin, end)
        self.score[runs, tried] = score[:, : end - begin]
        self.sign[runs, tried, : sign.shape[-1]] = sign[:, : end - begin]
        epochs = signal.shape[-1]
        self.signal[runs, tried, :epochs] = signal[:, : end - begin]
