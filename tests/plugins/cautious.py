"""A filter: the unscented one, begun with a wider covariance."""

from typing import Any, Literal

from debrisest.parts.filters.kalman import Unscented
from debrisest.roles import Given, Positive


class Cautious(Unscented):
    """The unscented Kalman filter whose start is ``factor`` times as uncertain."""

    kind: Literal["cautious"]
    factor: Positive

    def run(self, model: Any, given: Given) -> Any:
        """Return the estimates of all epochs."""
        return super().run(model, given._replace(covariance=self.factor**2 * given.covariance))
