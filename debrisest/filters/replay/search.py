"""How an anchor's replay seeks the least cost: with all that was measured, or without outliers."""

from typing import NamedTuple

from debrisest.arrays import Array
from debrisest.filters.replay.gauss_newton import CONVERGED, Solution, gauss_newton
from debrisest.filters.replay.measured_arc import MeasuredArc
from debrisest.filters.replay.robust import loss, robust_newton
from debrisest.filters.replay_model import ReplayModel

_ITERATIONS = 30


class Search(NamedTuple):
    """Over epochs 0 to `last`, of which `frames` were measured."""

    last: int
    frames: int
    gate: bool
    tolerance: float = CONVERGED
    iterations: int = _ITERATIONS

    def solve(self, model: ReplayModel, arc: MeasuredArc, starts: list[Array]) -> Solution:
        """Minimise the cost from the best of ``starts (run, n)``; with a gate it sets weights."""
        limits = self.iterations, self.tolerance
        if self.gate:
            return robust_newton(model, arc, starts, self.last, self.frames, *limits)
        return gauss_newton(model, arc, starts[0], self.last, *limits)

    def loss(self, model: ReplayModel, arc: MeasuredArc, found: Solution) -> Array:
        """What solutions are compared by (run,): the cost, or that of Cauchy, with outliers."""
        return loss(model, arc, found.at.state, self.last) if self.gate else found.cost
