"""Which runs of a file have their whole trajectories, and which only what they end with.

A trajectory is an estimate or an error vector of every epoch, or a covariance of several. Figures
of one run and `estimates` show them; tables and figures of all runs need the errors that are one
number per epoch, which every run keeps.
"""

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.vocabulary import VOCABULARY, axes_of

_OF_EPOCHS = ("time_s", "covariance_time_s")
_SMALL = 2**16
"""Bytes up to which the trajectories of a file are kept whatever is asked for."""


def is_trajectory(name: str, stage: str, dimensions: int) -> bool:
    """Return whether a dataset of so many axes is one, in a file of a stage."""
    if stage not in ("filter", "assess") or VOCABULARY[name].axes[:1] != ("run",):
        return False
    axes = axes_of(name, dimensions)[1:]
    return axes[:1] in {(axis,) for axis in _OF_EPOCHS} and (stage == "filter" or len(axes) > 1)


def thinned(data: Data, stage: str, whole: int) -> tuple[Data, int]:
    """Return what is kept of a file's data, and of how many runs, the first ones, all is kept.

    ``whole`` is how many are asked for. The others have NaN in place of their trajectories but for
    the last epoch.
    """
    runs = len(data["run"])
    long = [name for name, v in data.items() if is_trajectory(name, stage, v.ndim)]
    if not long or whole >= runs or sum(data[name].nbytes for name in long) <= _SMALL:
        return data, runs
    return data | {name: _ends(data[name], whole) for name in long}, whole


def _ends(value: Array, whole: int) -> Array:
    kept = np.full(value.shape, np.nan)
    kept[:whole] = value[:whole]
    kept[:, -1:] = value[:, -1:]
    return kept
