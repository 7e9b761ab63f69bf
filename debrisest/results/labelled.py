"""Data as an xarray Dataset, for those who have xarray."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from debrisest.arrays import Data
from debrisest.errors import UserError
from debrisest.vocabulary import COORDINATES, VOCABULARY, axes_of

if TYPE_CHECKING:
    import xarray


def labelled(data: Data, frames: Mapping[str, str]) -> "xarray.Dataset":
    """Return datasets with the axes, coordinates, units and names that the vocabulary gives them.

    ``frames`` becomes the attribute ``frame`` of the datasets it names. Raises UserError where
    xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise UserError("this needs xarray: pip install xarray") from None
    variables = {}
    for name, values in data.items():
        quantity = VOCABULARY[name]
        attributes = {"units": quantity.unit, "long_name": quantity.long_name}
        if name in frames:
            attributes["frame"] = frames[name]
        variables[name] = (axes_of(name, values.ndim), values, attributes)
    return xarray.Dataset(variables).set_coords([name for name in COORDINATES if name in data])
