"""The best arc over all starts."""

from debrisest.batch.evidence import Evidence
from debrisest.batch.local_rates import Local
from debrisest.batch.starts import starts
from debrisest.batch.windows import Growth, grow

_SAME = 1.0  # of the chi-square, in units of the noise


def search(evidence: Evidence, local: Local) -> Growth:
    """Return the first arc that explains the whole span, else the one that goes farthest.

    Where the noise is larger than said, nothing explains the data as they are said to be: then two
    starts that end at the same place, and leave nothing that lasts, are enough.
    """
    best: Growth | None = None
    for start in starts(local):
        growth = grow(evidence, start, local.half, local.noise)
        if growth.explains or (best is not None and _agree(growth, best)):
            return growth
        if best is None or _rank(growth) > _rank(best):
            best = growth
    assert best is not None, "there is always a start"
    return best


def _agree(growth: Growth, other: Growth) -> bool:
    stand = all(one.whole and one.fit.steady for one in (growth, other))
    return stand and abs(growth.found.chi2 - other.found.chi2) < _SAME * other.fit.excess


def _rank(growth: Growth) -> tuple[bool, float, float]:
    low, high = growth.span
    explained = growth.whole and growth.fit.steady
    return explained, high - low, -growth.fit.excess
