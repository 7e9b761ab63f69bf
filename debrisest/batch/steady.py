"""Whether a body is seen to do anything but turn steadily about one axis.

A steady spin shows no inertia, yet the best of all nutations always fits the noise a little better,
and its frequency, which is nothing but noise, looks well determined. So a nutation counts only if
it lowers the chi-square by more than noise does.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.arc import Arc
from debrisest.batch.descent import Descent, Prior, descend
from debrisest.batch.evidence import Evidence
from debrisest.batch.path import path_of
from debrisest.batch.spread import straight

_GAIN = 50.0  # of five unknowns, the best of hundreds of frequencies: about seven sigma
_SAMPLES = 100
_PLAIN = 50.0  # sigmas by which the rate changes where a nutation is plain to see
_SPHERE = Prior(np.zeros(5), 1e12 * np.eye(5))


def nutates_plainly(evidence: Evidence, arc: Arc, covariance: Array) -> bool:
    """Return whether the rate changes by far more than its sigma."""
    stride = -(-len(evidence.times) // _SAMPLES)
    path = path_of(arc, straight(arc, covariance), evidence.times[::stride])
    return bool(np.any(np.ptp(path.rate, axis=0) > _PLAIN * path.rate_sigma.max(axis=0)))


def turns_steadily(evidence: Evidence, found: Descent) -> bool:
    """Return whether a sphere, which can only spin, explains the data as well."""
    sphere = found.arc._replace(log_inertia=np.zeros(5))
    return descend(evidence, sphere, 30, _SPHERE).chi2 - found.chi2 < _GAIN
