"""A first guess that is written down, in the scenario or in a table beside it."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import ValidationInfo, field_validator, model_validator

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.errors import allowed_names
from debrisest.files import MOST_BYTES, require_ending
from debrisest.roles import Keys, NonNegative, SimulationPart
from debrisest.vocabulary import AXIS_LENGTH, VOCABULARY, possible_units, table_scale

if TYPE_CHECKING:
    from pandas import DataFrame

Nested = float | list[float] | list[list[float]]
_COLUMNS = ["name", "component", "value", "sigma"]


class GuessedQuantity(Keys):
    """A value with its standard deviation, the same in all components or one for each."""

    value: Nested
    """As many numbers as the quantity has, such as three, or a row of three for each feature."""
    sigma: NonNegative | list[NonNegative] | list[list[NonNegative]]
    """Standard deviation of each number, or one for all."""
    unit: str | None = None
    """`deg/s`, `deg` or `km` where it is not SI and radians."""


class GivenGuess(SimulationPart):
    """Values with their standard deviations, the same in every run."""

    tried = True
    kind: Literal["given"]
    quantities: dict[str, GuessedQuantity] = {}
    """What is guessed: a quantity is called as in the files of `simulate`, without `start_`."""
    file: str | None = None
    """CSV with the columns `name,component,value,sigma`, components counted from 1, rows of a list
    of lists after each other; in SI and radians."""

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, keys: Any, info: ValidationInfo) -> Any:
        """Add what the file says to the quantities, so that a changed file is noticed."""
        if not isinstance(keys, dict) or not isinstance(keys.get("file"), str):
            return keys
        path = Path((info.context or {}).get("folder", ".")) / keys["file"]
        return keys | {"quantities": {**keys.get("quantities", {}), **_read(path)}}

    @field_validator("quantities")
    @classmethod
    def _fitting(cls, quantities: dict[str, GuessedQuantity]) -> dict[str, GuessedQuantity]:
        for name, quantity in quantities.items():
            _require_fitting(name, quantity)
        return quantities

    @model_validator(mode="after")
    def _not_empty(self) -> "GivenGuess":
        if not self.quantities:
            raise ValueError("nothing is given; give quantities, or a file that has them")
        return self

    @property
    def given(self) -> tuple[str, ...]:
        """Return the datasets of the quantities that are given."""
        return tuple(f"start_{name}" for name in self.quantities)

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return each first guess and its sigma, in SI and radians."""
        result: Data = {}
        for name, quantity in self.quantities.items():
            _require_all_features(name, quantity, data)
            scale = table_scale(f"start_{name}", quantity.unit or "")
            value = np.asarray(quantity.value, dtype=np.float64) / scale
            sigma = np.broadcast_to(np.asarray(quantity.sigma) / scale, value.shape)
            for end, each in (("", value), ("_sigma", sigma)):
                result[f"start_{name}{end}"] = np.tile(each, (len(draws.runs), *[1] * value.ndim))
        return result


def _require_fitting(name: str, quantity: GuessedQuantity) -> None:
    declared = VOCABULARY.get(f"start_{name}")
    if declared is None:
        known = [other.removeprefix("start_") for other in VOCABULARY if other.startswith("start_")]
        allowed = [other for other in known if not other.endswith("_sigma")]
        raise ValueError(f"no estimator starts from {name!r}; {allowed_names(name, allowed)}")
    units = [unit for unit in possible_units(f"start_{name}") if unit]
    if quantity.unit is not None and quantity.unit not in units:
        said = allowed_names(quantity.unit, units)
        raise ValueError(f"{name} cannot be in {quantity.unit!r}; {said}")
    axes = declared.axes[1:]
    lengths = [AXIS_LENGTH.get(axis) for axis in axes]
    shape = _shape(name, quantity.value)
    if len(shape) != len(axes) or any(n not in (None, s) for n, s in zip(lengths, shape)):
        wanted = " x ".join(f"{axis} ({n or 'any number'})" for axis, n in zip(axes, lengths))
        raise ValueError(f"{name} needs {wanted} values, found {' x '.join(map(str, shape))}")
    if _shape(name, quantity.sigma) not in ((), shape):
        raise ValueError(f"{name}: sigma is one number, or one for each value")


def _require_all_features(name: str, quantity: GuessedQuantity, data: Data) -> None:
    wanted, found = len(data.get("feature", ())), len(np.atleast_1d(quantity.value))
    if "feature" in VOCABULARY[f"start_{name}"].axes and wanted not in (0, found):
        raise ValueError(f"{name} is given for {found} features, but there are {wanted}")


def _shape(name: str, values: Any) -> tuple[int, ...]:
    try:
        return np.asarray(values, dtype=np.float64).shape
    except ValueError:
        raise ValueError(f"{name}: all rows need as many values") from None


def _read(path: Path) -> dict[str, Any]:
    """Quantities of a CSV; components are counted from 1, rows of a table after each other."""
    import pandas as pd

    try:
        require_ending(path, MOST_BYTES)
        table = pd.read_csv(path, dtype={"name": str})
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror or 'cannot be read'}") from None
    except ValueError as error:
        raise ValueError(f"{path}: not a CSV: {str(error).splitlines()[0]}") from None
    if list(table.columns) != _COLUMNS:
        raise ValueError(f"{path}: the columns must be {','.join(_COLUMNS)}")
    return {str(name): _quantity(path, str(name), rows) for name, rows in table.groupby("name")}


def _quantity(path: Path, name: str, rows: "DataFrame") -> dict[str, Any]:
    rows = rows.sort_values("component")
    if rows["component"].tolist() != list(range(1, len(rows) + 1)):
        raise ValueError(f"{path}: the components of {name} must be 1 to {len(rows)}, each once")
    axes = VOCABULARY[f"start_{name}"].axes[1:] if f"start_{name}" in VOCABULARY else ()
    width = AXIS_LENGTH.get(axes[-1], 0) if len(axes) == 2 else 0
    return {key: _folded(rows[key].to_numpy(np.float64), width) for key in ("value", "sigma")}


def _folded(values: Array, width: int) -> Any:
    """Rows of as many values as the last axis has, where there are two axes."""
    whole = width and len(values) % width == 0
    return values.reshape(-1, width).tolist() if whole else values.tolist()
