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
    select: Callable[[IntArray], "Model"] | None = None

    def of(self, runs: IntArray) -> "Model":
        """Return the model of some runs."""
        return self if self.select is None else self.select(runs)
