"""Every stored quantity, as parts and problems declare them; the store and the tables read here."""

import numpy as np

from debrisest.parts.filters.quantities import QUANTITIES as FILTERS
from debrisest.parts.recoveries.quantities import QUANTITIES as RECOVERIES
from debrisest.parts.sensors.quantities import QUANTITIES as SENSORS
from debrisest.parts.sources.quantities import QUANTITIES as SOURCES
from debrisest.parts.truth.quantities import QUANTITIES as TRUTH
from debrisest.problems import quantities as shared
from debrisest.problems.camera_range import quantities as camera_range
from debrisest.problems.orbit_from_pixels import quantities as orbit_from_pixels
from debrisest.problems.shape import quantities as shape
from debrisest.problems.stereo_pose import quantities as stereo_pose
from debrisest.problems.tumbling import quantities as tumbling
from debrisest.quantity import RUN, Quantity

_OF_ALL_STAGES = {
    "run": Quantity(RUN, "1", "Monte Carlo run"),
    "time_s": Quantity(("time_s",), "s", "time since the start of the scenario"),
    "covariance_time_s": Quantity(("covariance_time_s",), "s", "times of the stored covariances"),
    "error_name": Quantity(("error_name",), "", "components of the filter's error state"),
    "failure": Quantity(RUN, "", "why the run gave no result (empty: it did)"),
    "status": Quantity(RUN, "", "how the stage ended, in words"),
    "recover_status": Quantity(RUN, "", "status of the recovery, as later stages read it"),
    "filter_status": Quantity(RUN, "", "status of the filter, as later stages read it"),
}

VOCABULARY: dict[str, Quantity] = {
    **_OF_ALL_STAGES,
    **TRUTH,
    **SENSORS,
    **SOURCES,
    **RECOVERIES,
    **FILTERS,
    **shared.QUANTITIES,
    **tumbling.QUANTITIES,
    **stereo_pose.QUANTITIES,
    **shape.QUANTITIES,
    **camera_range.QUANTITIES,
    **orbit_from_pixels.QUANTITIES,
}

COORDINATES = tuple(name for name, entry in VOCABULARY.items() if entry.axes == (name,))
"""Axes that have a coordinate of the same name; every other axis is a plain index."""

AXIS_LENGTH = {
    "quaternion": 4,
    "axis": 3,
    "row": 3,
    "column": 3,
    "image_axis": 2,
    **stereo_pose.AXIS_LENGTH,
    **camera_range.AXIS_LENGTH,
}

TWO_SIDED = tuple(name for name, entry in VOCABULARY.items() if entry.two_sided)
"""Quantities of the tables that are no errors: more is as bad as less."""

WHERE_KEPT = tuple(
    name for name, entry in VOCABULARY.items() if entry.chi_square and not entry.chi_square.white
)
"""Quantities of the tables that are known only where a filter kept its covariance."""

_TABLE_SCALE = {
    ("rad", "deg"): 180 / np.pi,
    ("rad", "mrad"): 1e3,
    ("rad/s", "deg/s"): 180 / np.pi,
    ("m", "km"): 1e-3,
    ("1", "%"): 100.0,
    ("m2", "km2"): 1e-6,
    ("N m", "mN m"): 1e3,
}
_FOR_PEOPLE = {"rad": "deg", "rad/s": "deg/s"}


def has_runs(name: str) -> bool:
    """Return whether a dataset's first axis is the run."""
    return VOCABULARY[name].axes[0] == "run"


def axes_of(name: str, dimensions: int) -> tuple[str, ...]:
    """Return the axes of a dataset; an error named like an estimated vector is its norm."""
    quantity = VOCABULARY[name]
    is_norm = quantity.table_unit and dimensions == len(quantity.axes) - 1
    axes = quantity.axes[:-1] if is_norm else quantity.axes
    if len(axes) != dimensions:
        raise ValueError(f"{name} has {dimensions} axes, the vocabulary says {quantity.axes}")
    return axes


def table_scale(name: str, unit: str = "") -> float:
    """Return the factor from a quantity's SI unit to a unit, by default that of the tables."""
    quantity = VOCABULARY[name]
    return _TABLE_SCALE.get((quantity.unit, unit or quantity.table_unit), 1.0)


def shown_unit(name: str) -> str:
    """Return the unit in which people see a quantity: that of the tables, degrees for angles."""
    quantity = VOCABULARY[name]
    return quantity.table_unit or _FOR_PEOPLE.get(quantity.unit, quantity.unit)


def possible_units(name: str) -> list[str]:
    """Return the units in which a table can show a quantity, its own first."""
    quantity = VOCABULARY[name]
    others = [unit for si, unit in _TABLE_SCALE if si == quantity.unit]
    return list(dict.fromkeys([quantity.table_unit, quantity.unit, *others]))
