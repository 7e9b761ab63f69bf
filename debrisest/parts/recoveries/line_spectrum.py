"""Recovery of the nine direction cosines from few lines off any grid."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data, IntArray
from debrisest.attitude.points import wahba_information
from debrisest.outcome import sentences
from debrisest.parts.recoveries.attitude import AttitudeRecovery
from debrisest.recovery.direction_cosines import attitude_of, entries, signs_from
from debrisest.recovery.line_spectrum import LineStatus, line_spectrum


class LineSpectrumRecovery(AttitudeRecovery):
    """Attitude of each epoch from its points, its nine direction cosines as a sum of few sines."""

    finished = LineStatus.COMPLETE
    kind: Literal["line_spectrum"]
    most_lines: Annotated[int, Field(ge=1)] = 30
    """Largest number of lines."""
    weights: Literal["points", "equal"] = "points"
    """Weights of the epochs: inversely as the variance of a least-squares attitude of the features
    seen, or all the same."""

    def recover_attitude(self, matrix: Array, raw: Array, piece: IntArray, data: Data) -> Data:
        """Return the rotations nearest to the recovered entries, and the signs that they give."""
        found = line_spectrum(entries(matrix), self._weight(data), self.most_lines)
        q, sign = signs_from(attitude_of(found.signal), raw, piece)
        return {
            "q_if": q,
            "sign": sign,
            "lines": np.isfinite(found.frequency).sum(axis=-1),
            "status": sentences(found.status, LineStatus),
        }

    def assess(self, data: Data) -> Data:
        """Return also the number of lines."""
        return super().assess(data) | {"lines": data["lines"]}

    def _weight(self, data: Data) -> Array | None:
        if self.weights == "equal":
            return None
        return wahba_information(data["known_point_f"][0], data["measured_point"])
