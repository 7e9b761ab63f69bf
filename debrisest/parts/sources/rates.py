"""Measured body rates in a text file: of a gyro on the target, or of a network."""

from pathlib import Path
from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.errors import UserError
from debrisest.parts.sources.from_files import FromFile, one_run
from debrisest.roles import Positive
from debrisest.tracks.read import read_measured
from debrisest.tracks.types import Rates


class MeasuredRates(FromFile):
    """Rates in axes fixed in the body, with their noise."""

    gives = ("measured_rate_f", "rate_f_noise")
    kind: Literal["rates"]
    sigma_deg_s: Positive | None = None
    """Standard deviation about each axis, where the file has none."""

    def read(self, folder: Path) -> Data:
        """Return the rates of one run."""
        found = read_measured(folder / self.file)
        if not isinstance(found, Rates):
            raise UserError(f"{folder / self.file}: this file holds no rates; use another kind")
        given = np.nan if self.sigma_deg_s is None else np.radians(self.sigma_deg_s)
        sigma = np.full(len(found.times), given) if found.sigma is None else found.sigma
        data: Data = {"measured_rate_f": found.rate, "rate_f_noise": sigma}
        return one_run(found.source, found.times, data, found.notes)
