"""The best arc over all starts."""

from debrisest.batch.evidence import Evidence
from debrisest.batch.local_rates import Local
from debrisest.batch.starts import starts
from debrisest.batch.windows import Growth, grow


def search(evidence: Evidence, local: Local) -> Growth:
    """Return the first arc that explains the whole span, else the one that goes farthest."""
    best: Growth | None = None
    for arc in starts(local):
        growth = grow(evidence, arc, local.half)
        if growth.explains:
            return growth
        if best is None or _rank(growth) > _rank(best):
            best = growth
    assert best is not None, "there is always a start"
    return best


def _rank(growth: Growth) -> tuple[bool, float, float]:
    low, high = growth.span
    explained = growth.whole and growth.fit.steady
    return explained, high - low, -growth.fit.excess
