"""What a filter is handed: a `Model` of a discrete-time system."""

from collections.abc import Callable
from typing import NamedTuple

from debrisest.arrays import Array, IntArray


def add(state: Array, error: Array) -> Array:
    """Retraction of a vector space."""
    return state + error


def subtract(state: Array, reference: Array) -> Array:
    """Inverse of `add`."""
    return state - reference


class PairedSteps(NamedTuple):
    """Functions of a model on pairs of points ``x +- scale l``, for an unscented filter.

    Columns l of a covariance's root are rows of an array here, ``(run, n, n)``, triangular.
    """

    move: Callable[[Array, Array, float], Array]
    """Replaces states (run, n) and columns by what they are a step later. Columns whose pairs move
    as the state does come last; the others go, to their number c, into an array (run, 2 c, n) that
    it returns: half the differences of their pairs, and behind these half the sums, less the
    state; both over the scale."""
    show: Callable[[Array, Array, float], tuple[Array, Array, Array]]
    """Returns what states show (run, m), half the differences of what pairs show (run, n, m), and
    half the sums, less the former; both over the scale."""


class Model(NamedTuple):
    """A discrete-time system with additive white noise, seen through an n_e-vector error.

    Every function gets arrays with leading batch axes, the run first: `x` is (run, ..., n).

    * `process(x, k)` takes a state from epoch k to k+1.
    * `measurement(x, k)` predicts what epoch k shows, (..., m).
    * `retract(x, e)` applies an error e (..., n_e) to a state and may project the result, for
      instance to unit quaternions.
    * `difference(x, y)` is the e with `retract(y, e) = x`. A model whose errors are not components
      of its state (n_e != n, or a curved state) must give both; without a `difference`, the errors
      are added.
    * `innovation(y, predicted)` may resolve an ambiguity of the measurement first, for instance
      the sign of a quaternion. A NaN component of `y` (not observed) must not spoil the others.
    * `process_jacobian(x, k)` (..., n_e, n_e) and `measurement_jacobian(x, k)` (..., m, n_e) are
      the derivatives of `difference(process(retract(x, e), k), process(x, k))` and of
      `measurement(retract(x, e), k)` by e at zero. They get x (run, n); leading axes of a constant
      one may be left out. A filter that needs one that is missing differentiates numerically.
    * `gate_groups` gives every measurement component the number of the group with which a gate
      accepts or rejects it; without it, every component is judged alone.
    * `paired` does what `process` and `measurement` do for the points of an unscented filter, where
      errors are added and nothing depends on the epoch.
    * `select(runs)` gives the model of some runs; without it, the model is the same for all.
    """

    process: Callable[[Array, int], Array]
    measurement: Callable[[Array, int], Array]
    process_noise: Array
    """Covariance added per step, (n_e, n_e)."""
    measurement_noise: Array
    """Covariance, (m, m)."""
    error_names: tuple[str, ...]
    retract: Callable[[Array, Array], Array] = add
    difference: Callable[[Array, Array], Array] = subtract
    innovation: Callable[[Array, Array], Array] = subtract
    process_jacobian: Callable[[Array, int], Array] | None = None
    measurement_jacobian: Callable[[Array, int], Array] | None = None
    gate_groups: tuple[int, ...] | None = None
    paired: PairedSteps | None = None
    select: Callable[[IntArray], "Model"] | None = None

    def of(self, runs: IntArray) -> "Model":
        """Return the model of some runs."""
        return self if self.select is None else self.select(runs)
