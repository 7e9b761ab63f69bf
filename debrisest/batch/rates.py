"""Measured body rates as evidence: a gyro, or a network that tells rates.

No attitude is measured: that of the arc's epoch names the inertial axes and is fixed.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.batch.arc import Course
from debrisest.batch.direct import Direct
from debrisest.batch.evidence import Epochs, Seen


class Rates(Direct):
    """Evidence of rates (time, 3), rad/s, with information in the body's axes."""

    of_rate = True
    unknowns_fixed = 3

    def errors(self, q: Array, rate: Array, epochs: Epochs) -> Array:
        """Return the rate that is measured less that of the motion (..., 3), rad/s."""
        return np.asarray(self.measured[epochs] - rate)

    def derivative(self, course: Course) -> Array:
        """Return that of the rate."""
        return course.rate_by

    def seen(self) -> Seen:
        """Return attitudes as the rates add up to them, from the first epoch on.

        Their information stands for the noise of a rate over one step; the drift does not matter
        to windows, whose attitude is compared with that of their middle.
        """
        step = np.diff(self.times)
        middle = 0.5 * (self.measured[1:] + self.measured[:-1])
        turns = quaternion.exp(middle * step[:, None])
        q = np.empty((len(self.times), 4))
        q[:1] = (1.0, 0.0, 0.0, 0.0)
        for k, turn in enumerate(turns):
            q[k + 1] = quaternion.multiply(q[k], turn)
        typical = np.median(step) if len(step) else 1.0
        return Seen(q, self.information / typical**2)
