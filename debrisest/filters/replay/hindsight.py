"""How far the estimates of kept epochs are to be trusted, by all that is known at the end."""

import numpy as np

from debrisest.arrays import IntArray
from debrisest.filters.estimates import Estimates, finite
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.rivals import DECISIVE
from debrisest.filters.verdict import Verdict

_SIGMAS = 4.0
"""From which on a number is elsewhere by what was measured later, which may have a share of it."""


def with_hindsight(model: ReplayModel, found: Estimates) -> Estimates:
    """Return what `replay` found and tests judged, with ``doubt_at (run, time)`` counted.

    At the kept epochs it is the code of a `Verdict`, NaN at all others: the run's own, or worse.
    Where another solution was about as good by the data of that time the estimate was ambiguous;
    where the motion found at the end passes it by farther than it said, it was wrong.
    """
    doubt, last = found.counts["doubt"], found.state.shape[1] - 1
    code = np.full(found.sigma.shape[:2], np.nan)
    code[:, found.kept] = doubt[:, None]
    runs = np.flatnonzero(finite(found.state[:, last], found.covariance[:, -1]))
    if len(runs):
        some = np.ix_(runs, found.kept)
        code[some] = np.maximum(code[some], _passed(model.of(runs), found, runs, last))
    return found._replace(counts=found.counts | {"doubt_at": code})


def _passed(model: ReplayModel, found: Estimates, runs: IntArray, last: int) -> IntArray:
    """Codes (run, kept) of some runs, by the motion that they end with."""
    some = np.ix_(runs, found.kept)
    with np.errstate(all="ignore"):
        motion = model.shown(model.rewind(found.state[runs, last], last), last)[0]
        off = np.abs(model.plain_difference(motion[:, found.kept], found.state[some]))
    wrong = (off > _SIGMAS * found.sigma[some]).any(-1)
    undecided = found.counts["rival_excess"][some] < DECISIVE
    code = np.where(undecided, Verdict.AMBIGUOUS, wrong * Verdict.LARGER)
    return np.asarray(code, dtype=np.int64)
