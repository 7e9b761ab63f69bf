"""What an association filter is handed: a system whose sensors deliver unlabelled points."""

from collections.abc import Callable
from typing import NamedTuple

from debrisest.arrays import Array, IntArray
from debrisest.filters.doubt import Doubt


class ScanModel(NamedTuple):
    """A discrete-time system seen by sensors that each deliver unlabelled points.

    Every function gets states x (run, ..., n), the run first; between it and the components there
    may be more axes, for instance one of tracks. Errors are added to the state. Leading axes of a
    constant Jacobian may be left out.

    * `process(x, k)` takes a state from epoch k to k+1.
    * `process_jacobian(x, k)` (run, ..., n, n) is its derivative at x.
    * `points(x, k)` predicts the point that each sensor shows at epoch k, (run, ..., sensor, d).
      Where a sensor cannot predict one (NaN), its scan is not used.
    * `points_jacobian(x, k)` (run, ..., sensor, d, n) is its derivative at x.
    * `doubted(x, k)` (run, ..., sensor, d, doubt) is the derivative of `points` by what the model
      takes for granted, the `doubts`.
    * `select(runs)` gives the model of some runs; without it, the model is the same for all.
    """

    process: Callable[[Array, int], Array]
    process_jacobian: Callable[[Array, int], Array]
    process_noise: Array
    """Covariance added per step, (n, n); it may be singular."""
    points: Callable[[Array, int], Array]
    points_jacobian: Callable[[Array, int], Array]
    noise: Array
    """Covariance of a point, (d, d)."""
    error_names: tuple[str, ...]
    doubts: tuple[Doubt, ...] = ()
    doubted: Callable[[Array, int], Array] | None = None
    select: Callable[[IntArray], "ScanModel"] | None = None

    def of(self, runs: IntArray) -> "ScanModel":
        """Return the model of some runs."""
        return self if self.select is None else self.select(runs)
