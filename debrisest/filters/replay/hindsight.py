"""How far the estimates of kept epochs are to be trusted, by all that is known at the end."""

import numpy as np

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
    part = model.of(runs)
    with np.errstate(all="ignore"):
        motion = part.shown(part.rewind(found.state[runs, last], last), last)[0]
        for k in found.kept:
            off = np.abs(part.plain_difference(motion[:, k], found.state[runs, k]))
            wrong = (off > _SIGMAS * found.sigma[runs, k]).any(-1)
            open_ = found.counts["rival_excess"][runs, k] < DECISIVE
            own = np.where(open_, Verdict.AMBIGUOUS, np.where(wrong, Verdict.LARGER, 0))
            code[runs, k] = np.maximum(code[runs, k], own)
    return found._replace(counts=found.counts | {"doubt_at": code})
