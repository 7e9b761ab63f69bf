"""Whether a body is seen to do anything but turn steadily about one axis.

A steady spin shows no inertia, yet the best of all nutations always fits the noise a little better,
and its frequency, which is nothing but noise, looks well determined. So a nutation counts only if
it lowers the chi-square by more than noise does.
"""

import numpy as np

from debrisest.batch.descent import Descent, Prior, descend
from debrisest.batch.evidence import Evidence

_GAIN = 50.0  # of five unknowns, the best of hundreds of frequencies: about seven sigma
_SPHERE = Prior(np.zeros(5), 1e12 * np.eye(5))


def turns_steadily(evidence: Evidence, found: Descent) -> bool:
    """Return whether a sphere, which can only spin, explains the data as well."""
    sphere = found.arc._replace(log_inertia=np.zeros(5))
    return descend(evidence, sphere, 30, _SPHERE).chi2 - found.chi2 < _GAIN
