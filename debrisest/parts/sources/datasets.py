"""Measured data in a file like those of the stage simulate."""

from hashlib import sha256
from pathlib import Path
from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.errors import UserError
from debrisest.files import content
from debrisest.results import store
from debrisest.roles import SourcePart
from debrisest.vocabulary import AXIS_LENGTH, VOCABULARY, has_runs

_WANTED = "give a file of the stage simulate, or one that debrisest import wrote"


class Datasets(SourcePart):
    """Known and measured datasets by their names; runs that failed are left out.

    What the file holds of a truth, such as that of a laboratory, is for ``assess`` alone.
    """

    kind: Literal["datasets"]
    file: str
    """HDF5 file, from the scenario's folder; runs that failed are left out."""

    @property
    def files(self) -> list[str]:
        """Return the file."""
        return [self.file]

    def read(self, folder: Path) -> Data:
        """Return the datasets of the file; UserError if it is not whole or lacks the essential."""
        path = folder / self.file
        found = store.inspect(path)
        if found.condition is not store.Condition.WHOLE:
            raise UserError(f"{path} is {found.condition.value}; {_WANTED}")
        if (stage := found.attributes.get("stage")) != "simulate":
            raise UserError(f"{path} is a file of the stage {stage}; {_WANTED}")
        data = store.read(path)
        _require_times(path, data)
        _require_shapes(path, data)
        _require_sigmas(path, data)
        return _good(data)

    def digest(self, folder: Path) -> str:
        """Return the SHA-256 of the file."""
        return sha256(content(folder / self.file)).hexdigest()


def _require_times(path: Path, data: Data) -> None:
    times = data.get("time_s", np.empty(0))
    if len(times) < 2 or not np.all(np.diff(times) > 0):
        raise UserError(f"{path}: time_s needs at least two epochs, in seconds, ascending")
    if "run" not in data:
        raise UserError(f"{path}: the dataset run is missing; a single experiment is run 0")


def _require_shapes(path: Path, data: Data) -> None:
    lengths: dict[str, int] = dict(AXIS_LENGTH)
    for name, value in data.items():
        axes = VOCABULARY[name].axes
        if value.ndim != len(axes):
            raise UserError(f"{path}: {name} has {value.ndim} axes; needed: {', '.join(axes)}")
        for axis, length in zip(axes, value.shape):
            if lengths.setdefault(axis, length) != length:
                raise UserError(
                    f"{path}: {name} has {length} values along {axis}, not {lengths[axis]}"
                )


def _require_sigmas(path: Path, data: Data) -> None:
    for name in data:
        if f"{name}_sigma" in VOCABULARY and f"{name}_sigma" not in data:
            raise UserError(f"{path}: {name} needs {name}_sigma beside it, of the same shape")


def _good(data: Data) -> Data:
    failure = data.pop("failure", np.full(len(data["run"]), ""))
    good = np.flatnonzero(failure == "")
    kept = {name: value[good] if has_runs(name) else value for name, value in data.items()}
    return kept | {"run": np.arange(len(good), dtype=np.float64)}
