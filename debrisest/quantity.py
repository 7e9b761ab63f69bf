"""What is told of a stored quantity: axes, unit, words.

Values are SI and radians; an error's table unit is what the tables print. Frames are suffixes:
``i`` inertial axes, ``b`` body axes, ``f`` the frame built on the target's first three features,
``c`` camera. NaN means "not observed" or "not available" everywhere.
"""

from typing import NamedTuple


class ChiSquare(NamedTuple):
    """Where a quantity is, if the estimator is consistent, a chi-square over its freedom."""

    freedom: str
    """The dataset that holds its degrees of freedom."""
    white: bool
    """Whether its values at different epochs are independent."""
    of_costs: bool = False
    """Whether it is a difference of costs, which is too small only where the estimate's is no
    minimum."""


class Quantity(NamedTuple):
    """What a dataset holds: its axes, its SI unit, its name in words and its unit in tables."""

    axes: tuple[str, ...]
    unit: str
    long_name: str
    table_unit: str = ""
    chi_square: ChiSquare | None = None
    """Of a normalised square per dimension, which the tables judge in words."""
    after_figure: str = ""
    """What follows its figure in a laid-out table."""
    two_sided: bool = False
    """Of a quantity of the tables that is no error: more is as bad as less."""


RUN = ("run",)
RUN_VECTOR = ("run", "axis")
POINT = ("run", "feature", "axis")
TIME = ("run", "time_s")
TIME_VECTOR = (*TIME, "axis")
TIME_QUATERNION = (*TIME, "quaternion")


def with_sigmas(estimated: dict[str, Quantity]) -> dict[str, Quantity]:
    """Return quantities that are estimated, and their standard deviations, ``_sigma`` added."""
    return estimated | {
        f"{name}_sigma": Quantity(entry.axes, entry.unit, f"1-sigma of {name}")
        for name, entry in estimated.items()
    }
