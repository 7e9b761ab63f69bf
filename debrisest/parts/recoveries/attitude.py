"""What all recoveries of an attitude share: attitudes of single epochs before, errors after."""

from abc import abstractmethod
from collections.abc import Callable
from typing import ClassVar, Literal

import numpy as np

from debrisest.arrays import Array, Data, IntArray
from debrisest.assessment.attitude import attitude_errors, true_feature_attitude
from debrisest.assessment.signs import signs_right
from debrisest.assessment.statistics import rms_where
from debrisest.attitude import quaternion
from debrisest.attitude.points import triad, wahba
from debrisest.clock import Clock
from debrisest.outcome import Outcome
from debrisest.recovery.pieces import continuous, pieces
from debrisest.roles import RecoveryPart

_ATTITUDES: dict[str, Callable[[Array, Array], Array]] = {"triad": triad, "wahba": wahba}


MOST_JITTER = 0.01
"""Part of a step by which an epoch may be off: a turn as small beside what a step turns."""


class AttitudeRecovery(RecoveryPart):
    """Attitude of each epoch from its points; a signal over all epochs from these attitudes.

    The spectra take epochs for equidistant, so that they must be, but for a small jitter.
    """

    needs = ("measured_point", "known_point_f")
    gives = ("q_if",)
    finished: ClassVar[Outcome]
    """How the solver ends where nothing stops it early."""
    attitude: Literal["triad", "wahba"]
    """Attitude of an epoch: from the first three visible features that are not in line, or least
    squares of all visible ones."""

    @abstractmethod
    def recover_attitude(self, matrix: Array, raw: Array, piece: IntArray, data: Data) -> Data:
        """Return signal, signs and status.

        From rotation matrices (run, time, 3, 3), the same as quaternions (run, time, 4) continuous
        in each piece, and the piece (run, time) of each epoch, -1 where there is no attitude.
        """

    def recover(self, data: Data, clock: Clock) -> Data:
        """Return raw and recovered attitude (run, time, 4) with the solver's words on it."""
        _require_even(clock)
        matrix = _ATTITUDES[self.attitude](data["known_point_f"][0], data["measured_point"])
        raw = quaternion.from_matrix(matrix)
        piece = pieces(np.isfinite(raw[..., 0]))
        raw = continuous(raw, piece)
        return {
            "raw_q_if": raw,
            "piece": np.where(piece < 0, np.nan, piece),
            **self.recover_attitude(matrix, raw, piece, data),
        }

    def assess(self, data: Data) -> Data:
        """Return what the recovery says of itself, and its errors if there is a truth."""
        observed = np.isfinite(data["piece"])
        result: Data = {
            "coverage": observed.mean(axis=-1),
            "pieces": np.isfinite(data["sign"]).sum(axis=-1),
            "solved": data["recover_status"] == self.finished.sentence,
        }
        if "true_q_ib" not in data:
            return result
        true_q_if = true_feature_attitude(data)
        right = signs_right(data["raw_q_if"], data["piece"], data["sign"], true_q_if)
        pitch, angle = attitude_errors(data["q_if"], true_q_if)
        return result | {
            "signs_right": right,
            "signs_all_right": right == 1,
            "recovered_pitch": pitch,
            "recovered_attitude": angle,
            "observed_pitch": rms_where(observed, pitch),
            "observed_attitude": rms_where(observed, angle),
            "gap_pitch": rms_where(~observed, pitch),
            "gap_attitude": rms_where(~observed, angle),
        }


def _require_even(clock: Clock) -> None:
    if clock.jitter > MOST_JITTER:
        raise ValueError(
            f"the epochs are up to {clock.jitter:.2g} steps away from an even grid, and at most "
            f"{MOST_JITTER:g} is allowed; resample the points, or estimate from the points "
            "themselves, at their own times (problem tumbling_points)"
        )
