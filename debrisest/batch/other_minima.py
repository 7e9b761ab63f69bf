"""Whether another inertia explains the data as well.

Where a nutation is small, the chi-square may have several minima with different inertias, all of
which explain the data: a descent ends in one of them, and its covariance knows nothing of the rest.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.arc import INERTIA
from debrisest.batch.descent import Descent, covariance, descend_all
from debrisest.batch.evidence import Evidence
from debrisest.batch.starts import inertia_guesses

_AS_WELL = 25.0  # of the chi-square, five sigma
_APART = 25.0  # squared distance of inertias, of five, in the better one's sigmas
_ITERATIONS = 100


def lowest_minimum(evidence: Evidence, found: Descent) -> tuple[Descent, bool]:
    """Return the best end of descents, from ``found`` and other inertias, and whether it is alone.

    It is not where another end explains the data about as well, with an inertia far off.
    """
    starts = [found.arc._replace(log_inertia=guess) for guess in inertia_guesses()]
    ends = descend_all(evidence, [found.arc, *starts], _ITERATIONS)
    best = min(ends, key=lambda end: end.chi2)
    information = _information(best, evidence.unknowns_fixed)
    rivals = [end for end in ends if end.chi2 < best.chi2 + _AS_WELL]
    gaps = [end.arc.log_inertia - best.arc.log_inertia for end in rivals]
    return best, all(gap @ information @ gap < _APART for gap in gaps)


def _information(found: Descent, fixed: int) -> Array:
    """Information (5, 5) of the inertia, the other unknowns being open."""
    return np.asarray(np.linalg.pinv(covariance(found.hold, fixed)[INERTIA, INERTIA]))
