"""What the replay filter is handed: a `ReplayModel` of a system without process noise."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.model import add


class Doubt(NamedTuple):
    """A number that the model holds at zero, and that the measurements can speak against."""

    reason: str
    """What to say if they do; ``{size}`` is the number times `scale`, ``{value}`` its sigmas."""
    scale: float
    column: Callable[[Array, Array, Array, Array], Array]
    """(states, sensitivities, measurements, derivative) of all epochs, from 0 on, as `trajectory`
    and `rows` give them -> derivative of the measurements by the number, (run, epoch, m)."""


class PointRows(NamedTuple):
    """Rows of N points, r each, that depend on the first n_c errors and on three of their own.

    The errors of the points follow the first n_c, in order; the rows that are no point's come last.
    """

    shown: Array
    """(run, epoch, m)."""
    by_point: Array
    """By the first errors and the point's own, (run, epoch, N, r, n_c + 3)."""
    by_rest: Array
    """Of the other rows by the first errors, (run, epoch, m - N r, n_c)."""

    def derivative(self) -> Array:
        """Return the derivative ``(run, epoch, m, n_c + 3 N)`` by all errors."""
        runs, epochs, points, each, own = self.by_point.shape
        n_c, of_points = own - 3, points * each
        n_e = n_c + 3 * points
        result = np.zeros((runs, epochs, self.shown.shape[-1], n_e))
        block = result[:, :, :of_points].reshape(runs, epochs, points, each, n_e)
        block[..., :n_c] = self.by_point[..., :n_c]
        for i in range(points):
            block[:, :, i, :, n_c + 3 * i : n_c + 3 * i + 3] = self.by_point[:, :, i, :, n_c:]
        result[:, :, :of_points] = block.reshape(runs, epochs, of_points, n_e)
        result[:, :, of_points:, :n_c] = self.by_rest
        return result


class Frames(NamedTuple):
    """The filter between the anchors, of a model that has it for less; runs first, as there."""

    carry: Callable[[Array, Array, Array, Array, int, int, bool], Array]
    """(states before and after, information before, sensitivities of those after, first epoch,
    last, whether it is plain or in the charts of those before) -> that in those after."""
    update: Callable[[Array, Array, int, Array, Array, bool, tuple[int, float]], Array]
    """(states, information, epoch, normalised measurements (run, m), weights, whether with a gate,
    most iterations and when they end) -> NIS (run,); the others are updated in place."""
    move: Callable[[Array, Array], Array]
    """(states, steps in plain errors) -> states, by way of their charts and of `retract`."""
    covariance: Callable[[Array, Array], Array]
    """(states, information in their charts) -> plain covariances (run, n_e, n_e)."""


class ReplayModel(NamedTuple):
    """A deterministic system whose whole motion follows from its state at epoch 0.

    It has two charts of errors, n_e numbers each: a *plain* one, in which the prior is Gaussian and
    the derivatives are taken, and one of its own for each state (its *chart*), in which what is
    measured depends nearly linearly on the errors, and in which states are corrected. Arrays have
    the run first. "Sensitivities" are whatever numbers, one set an epoch, from which `rows` and
    `transition` know the derivative by the state at the first epoch.
    """

    trajectory: Callable[[Array, int, int], tuple[Array, Array]]
    """(state (run, n), first, last) -> states (run, epoch, n), sensitivities (run, epoch, ...)."""
    rows: Callable[[Array, Array, int, IntArray], tuple[Array, Array]]
    """(states, sensitivities, first, epochs) -> measurements (run, epoch, m), derivative
    (run, epoch, m, n_e) by the plain errors at `first`."""
    transition: Callable[[Array, int, int], Array]
    """(sensitivities of epoch last (run, ...), first, last) -> plain errors of `last` by those of
    `first`, (run, n_e, n_e)."""
    rewind: Callable[[Array, int], Array]
    """(state, epoch) -> state at epoch 0."""
    chart: Callable[[Array], Array]
    """state -> its own errors by plain errors, (run, n_e, n_e)."""
    inverse_chart: Callable[[Array], Array]
    """Inverse of `chart`."""
    retract: Callable[[Array, Array], Array]
    """(state, error in its own chart) -> state; may keep it physical."""
    difference: Callable[[Array, Array], Array]
    """(state, reference) -> error in the reference's own chart."""
    plain_difference: Callable[[Array, Array], Array]
    """(state, reference) -> plain error."""
    start: Callable[[Array, Array, int], Array]
    """(prior at epoch 0, measurements (run, m) of the first epoch that has any, that epoch) -> a
    state at epoch 0 to begin with. It may be the prior itself."""
    sigma: Array
    """Noise of the measurements, (m,); they are independent."""
    error_names: tuple[str, ...]
    """Of the plain errors."""
    displace: Callable[[Array, Array], Array] = add
    """Exact inverse of `difference`, physical or not, with which a bound's errors make states."""
    excess: Callable[[Array, Array], tuple[Array, Array]] | None = None
    """(state, step in plain errors (run, n_e)) -> what `retract` limits of a step: its derivative
    (run, c, n_e), and by how much it has to change (run, c), zero where it need not."""
    doubts: tuple[Doubt, ...] = ()
    bending: tuple[int, ...] = ()
    """Errors that the measurements may tell along a bent valley of the cost only."""
    mirror: Callable[[Array], Array] | None = None
    """state -> another one that may fit the measurements about as well; none: there is none."""
    point_rows: Callable[[Array, Array, int, IntArray], PointRows] | None = None
    """The same as `rows`, for a model whose rows depend on few errors each."""
    sums: Callable[[Array, Array, int, IntArray, Array, Array], tuple[Array, ...]] | None = None
    """(what `rows` takes, normalised measurements (run, epoch, m), weights) -> information
    (run, n_e, n_e), gradient (run, n_e) and cost (run,), for a model that has them for less."""
    course: Callable[[Array, int], tuple[Array, Array]] | None = None
    """(state at epoch 0, last) -> states (run, epoch, n) and measurements (run, epoch, m) up to
    epoch `last`, for a model that has them for less without derivatives."""
    frames: Frames | None = None
    select: Callable[[IntArray], "ReplayModel"] | None = None
    """The model of some runs; without it, the model is the same for all."""

    def of(self, runs: IntArray) -> "ReplayModel":
        """Return the model of some runs."""
        return self if self.select is None else self.select(runs)

    def shown(self, state: Array, last: int) -> tuple[Array, Array]:
        """Return what `course` does, of any model."""
        if self.course is not None:
            return self.course(state, last)
        states, sensitivity = self.trajectory(state, 0, last)
        return states, self.rows(states, sensitivity, 0, np.arange(last + 1))[0]
