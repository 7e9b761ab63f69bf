"""Ways to weigh the detections of a sensor."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.association.joint import joint
from debrisest.filters.association.weights import (
    Validation,
    absence_weight,
    nearest,
    probabilistic,
)

Way = Literal["nearest", "probabilistic", "joint"]


@dataclass(frozen=True)
class Weighing:
    """From squared distances, infinite where not validated, to the probabilities of detections."""

    way: Way
    validation: Validation
    d: int
    """Components of a detection."""

    def __call__(self, distance: Array) -> Array:
        """Return the probabilities (run, track, sensor, detection) at distances of that shape."""
        if self.way == "nearest":
            return nearest(distance)
        if self.way == "probabilistic":
            return probabilistic(distance, self.validation, self.d)
        by_sensor = joint(np.swapaxes(distance, 1, 2), self.validation, self.d)
        return np.swapaxes(by_sensor, 1, 2)

    @property
    def numbers(self) -> tuple[int, float]:
        """Return which way it is, and the weight of absence for each detection, for the loops."""
        absence = absence_weight(np.array(1), self.validation, self.d)
        return get_args(Way).index(self.way), float(absence)
