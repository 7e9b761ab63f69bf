"""What an association filter is handed: a system whose sensors deliver unlabelled points."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

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
    * `both(x, k)` is `process` with its derivative, and `all_seen(x, k)` what is seen with its two,
      that of the target (track 0) by the doubts, where these cost less together.
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
    both: Callable[[Array, int], tuple[Array, Array]] | None = None
    all_seen: Callable[[Array, int], tuple[Array, Array, Array]] | None = None

    def of(self, runs: IntArray) -> "ScanModel":
        """Return the model of some runs."""
        return self if self.select is None else self.select(runs)

    def moved(self, x: Array, k: int) -> tuple[Array, Array]:
        """Return states (run, track, n) an epoch later, and their derivative (..., n, n)."""
        if self.both is not None:
            return self.both(x, k)
        shape = (*x.shape, x.shape[-1])
        return self.process(x, k), np.broadcast_to(self.process_jacobian(x, k), shape)

    def seen(self, x: Array, k: int) -> tuple[Array, Array, Array]:
        """Return points (run, track, sensor, d), their derivatives, and the target's by the doubts.

        The latter (run, sensor, d, doubt) are zero where nothing is seen.
        """
        if self.all_seen is not None:
            return self.all_seen(x, k)
        points = self.points(x, k)
        h = np.broadcast_to(self.points_jacobian(x, k), (*points.shape, x.shape[-1]))
        if self.doubted is None:
            return points, h, np.zeros((*points[:, 0].shape, 0))
        return points, h, np.nan_to_num(self.doubted(x[:, 0], k))
