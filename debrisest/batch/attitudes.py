"""Measured attitudes as evidence: poses of a network, of a perspective solver, of markers."""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.batch.arc import Course
from debrisest.batch.direct import Direct
from debrisest.batch.evidence import Epochs, Seen


class Attitudes(Direct):
    """Evidence of ``q_if (time, 4)``, of either sign, with information in inertial axes."""

    of_rate = False
    unknowns_fixed = 0

    def errors(self, q: Array, rate: Array, epochs: Epochs) -> Array:
        """Return the turn from the motion to what is measured, inertial (..., 3), rad."""
        measured = self.measured[epochs]
        return quaternion.log(quaternion.multiply(measured, quaternion.conjugate(q)))

    def derivative(self, course: Course) -> Array:
        """Return that of the attitude."""
        return course.turn_by

    def seen(self) -> Seen:
        """Return the attitudes themselves."""
        return Seen(np.where(self.dof[:, None] > 0.0, self.measured, np.nan), self.information)
