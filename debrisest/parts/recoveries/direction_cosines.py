"""Recovery of the nine direction cosines by basis pursuit: no sign to search for."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data, IntArray
from debrisest.outcome import sentences
from debrisest.parts.recoveries.attitude import AttitudeRecovery
from debrisest.parts.recoveries.pursuit import PursuitKeys
from debrisest.recovery.basis_pursuit import RecoveryStatus
from debrisest.recovery.direction_cosines import attitude_of, entries, signs_from


class DirectionCosines(PursuitKeys, AttitudeRecovery):
    """Attitude of each epoch from its points, its nine direction cosines by basis pursuit."""

    version = 2
    finished = RecoveryStatus.CONVERGED
    kind: Literal["direction_cosines"]

    def recover_attitude(self, matrix: Array, raw: Array, piece: IntArray, data: Data) -> Data:
        """Return the rotations nearest to the recovered entries, and the signs that they give."""
        solution = self.pursue(entries(matrix))
        q, sign = signs_from(attitude_of(np.moveaxis(solution.signal, 1, -1)), raw, piece)
        worst = sentences(solution.status.max(axis=-1), RecoveryStatus)
        return {"q_if": q, "sign": sign, "status": worst}
