"""Filters that a scenario can name."""

from typing import Literal

from debrisest.arrays import Array
from debrisest.filters.history import History
from debrisest.filters.model import Model
from debrisest.filters.unscented import UnscentedParameters, unscented
from debrisest.roles import FilterPart, Positive


class Unscented(FilterPart):
    """The unscented Kalman filter; the paper's form does not redraw its sigma points."""

    kind: Literal["unscented"]
    alpha: Positive = 1.0
    beta: float = 2.0
    kappa: float = 0.0
    redraw: bool = False

    def run(self, model: Model, state: Array, covariance: Array, measured: Array) -> History:
        """Return the history of the estimate over all epochs."""
        spread = UnscentedParameters(self.alpha, self.beta, self.kappa)
        return unscented(model, state, covariance, measured, spread, redraw=self.redraw)
