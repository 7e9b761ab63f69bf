"""What a filter hands over of its history."""

from debrisest.arrays import Array, IntArray
from debrisest.filters.history import FilterStatus, History
from debrisest.outcome import sentences
from debrisest.roles import Filtered


def filtered(history: History, gated: bool = False, **counts: Array | IntArray) -> Filtered:
    """Return a history with its repairs, what a gate did if there is one, and further counts."""
    gate = {"rejected": history.rejected, "reopened": history.reopened} if gated else {}
    return Filtered(
        *(history.state, history.sigma, history.covariance, history.kept),
        *(history.nis, history.nis_dof),
        status=sentences(history.status, FilterStatus),
        counts={"repairs": history.repairs, **gate, **counts},
    )
