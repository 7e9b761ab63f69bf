"""What the landmark filters are handed: a `LandmarkModel`, a moving core and points fixed in it."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.doubt import Doubt


class Rows(NamedTuple):
    """What epochs show of states, and how it depends on their errors.

    N landmarks show r components each, of which each depends on the core and on its own landmark;
    m common components depend on the core alone.
    """

    shown: Array
    """(..., N, r)."""
    by_core: Array
    """(..., N, r, s), by the s errors of the core that rows depend on."""
    by_point: Array
    """(..., N, r, 3)."""
    common: Array
    """(..., m)."""
    common_by_core: Array
    """(..., m, s)."""
    shared: Array
    """Noise that all landmarks of an epoch share, per unit of each of its c causes,
    (..., N, r, c); c may be zero."""


class Course(NamedTuple):
    """Cores of some epochs, and what their errors are by the parameters of the start."""

    cores: Array
    """(run, epoch, n)."""
    by_start: Callable[[slice], Array]
    """Some of the epochs -> (run, epoch, s, n_x), of the errors that rows depend on."""
    last: Array
    """(run, n_c, n_x), of all errors of the last epoch."""


class Observations(NamedTuple):
    """Measurements of runs and epochs, zero where nothing was seen."""

    shown: Array
    """(run, ..., N, r)."""
    seen: BoolArray
    """Same shape as `shown`."""
    common: Array
    """(run, ..., m)."""
    common_seen: BoolArray

    def at(self, *index: Any) -> "Observations":
        """Return those of some runs and epochs."""
        parts: list[Any] = [values[index] for values in self]
        return Observations(*parts)


class LandmarkModel(NamedTuple):
    """A deterministic motion of a *core* state and of N points that are constant vectors.

    The core (run, n) has n_c errors, the first `held` of which follow from the others at epoch 0
    where the start is one of the model's own: then the core is `start` of n_c - held parameters,
    which are a vector space. Errors of points are added. A state is the core with the points
    behind it, its errors are those of the core, then of the points. The run is the first axis;
    further axes are epochs.
    """

    landmarks: int
    rows_each: int
    common: int
    held: int
    sigma: Array
    """Noise of a landmark's components (r,); all noise is independent but for `Rows.shared`."""
    common_sigma: Array
    """(m,)."""
    error_names: tuple[str, ...]
    """Of the core and of the points, n_c + 3 N."""
    shown_by: IntArray
    """Errors of the core (s,), of their own epoch, that rows depend on."""
    start: Callable[[Array], tuple[Array, Array]]
    """parameters (run, n_c - held) -> core (run, n) at epoch 0, and the derivative
    (run, n_c, n_c - held) of its errors."""
    parameters: Callable[[Array], Array]
    """Inverse of `start`."""
    mirror: Callable[[Array, Array], tuple[Array, Array]]
    """(parameters, points (run, N, 3)) -> those of the other motion that looks nearly the same."""
    path: Callable[[Array, int], Array]
    """(core at epoch 0, last) -> cores (run, last + 1, n)."""
    course: Callable[[Array, IntArray], Course]
    """(parameters, ascending epochs) -> the course of that start over them."""
    trajectory: Callable[[Array, int], tuple[Array, Array]]
    """(core at epoch 0, last) -> cores (run, last + 1, n), errors of each epoch by those of epoch 0
    (run, last + 1, n_c, n_c)."""
    process: Callable[[Array], tuple[Array, Array]]
    """core -> core one epoch later, and the derivative (run, n_c, n_c) of its errors."""
    rows: Callable[[Array, Array, IntArray], Rows]
    """(cores (run, epoch, n), points (run, 1, N, 3), epochs) -> rows (run, epoch, ...)."""
    place: Callable[[Array, Array, IntArray], tuple[Array, Array, Array]]
    """(cores (run, N, n), what each landmark showed (run, N, r), epochs (run, N)) -> points
    (run, N, 3), their derivative (run, N, 3, n_c) by the core's errors, and the covariance
    (run, N, 3, 3) that does not come from these."""
    retract: Callable[[Array, Array], Array]
    """(core, error) -> core."""
    difference: Callable[[Array, Array], Array]
    """(core, reference) -> error with which `retract` takes the reference there."""
    of: Callable[[IntArray], "LandmarkModel"]
    """The model of some of the runs, any number of times each."""
    doubts: tuple[Doubt, ...] = ()
    """What the model takes for granted."""
    doubted: Callable[[], "LandmarkModel"] | None = None
    """The model in which each doubt is one more error of the core, and one more parameter."""
    gauge: Callable[[Array, Array], Array] | None = None
    """(core, points (run, N, 3)) -> errors (run, n_c + 3 N, g) in g directions that no measurement
    tells; none where the start is one of the model's own, which holds them."""
    directions: int = 2
    """Leading components of a landmark, its pixels, without which `place` puts it nowhere."""

    @property
    def errors(self) -> int:
        """Number of the core's errors."""
        return len(self.error_names) - 3 * self.landmarks

    def placeable(self, seen: BoolArray) -> BoolArray:
        """Which landmarks (..., N) show, by what was seen (..., N, r), where they are."""
        return np.asarray(seen[..., : self.directions].all(-1))


def split(model: LandmarkModel, measured: Array) -> Observations:
    """Return measurements ``(run, time, N r + m)``, landmark by landmark."""
    seen = ~np.isnan(measured)
    filled, each = np.where(seen, measured, 0.0), model.landmarks * model.rows_each
    shape = (*measured.shape[:-1], model.landmarks, model.rows_each)
    return Observations(
        filled[..., :each].reshape(shape),
        seen[..., :each].reshape(shape),
        filled[..., each:],
        seen[..., each:],
    )


def core_of(model: LandmarkModel, state: Array) -> Array:
    """Core (..., n) of a whole state."""
    return state[..., : state.shape[-1] - 3 * model.landmarks]


def points_of(model: LandmarkModel, state: Array) -> Array:
    """Points (..., N, 3) of a whole state."""
    first = state.shape[-1] - 3 * model.landmarks
    return state[..., first:].reshape(*state.shape[:-1], model.landmarks, 3)


def joined(core: Array, points: Array) -> Array:
    """Whole state (..., n + 3 N)."""
    return np.concatenate([core, in_line(points)], axis=-1)


def in_line(points: Array) -> Array:
    """Coordinates (..., 3 N) of points (..., N, 3), of which there may be no run at all."""
    return points.reshape(*points.shape[:-2], 3 * points.shape[-2])
