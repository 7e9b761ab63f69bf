"""Recoveries: from the measurements of single epochs to a signal over all epochs."""

from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data, IntArray
from debrisest.assessment.attitude import attitude_errors, true_feature_attitude
from debrisest.assessment.signs import signs_right
from debrisest.attitude import quaternion
from debrisest.attitude.points import triad, wahba
from debrisest.clock import Clock
from debrisest.outcome import sentences
from debrisest.recovery.basis_pursuit import Recovered, RecoveryStatus, basis_pursuit
from debrisest.recovery.fourier import dictionary_length
from debrisest.recovery.pieces import continuous, pieces
from debrisest.recovery.signs import lasso_score, search_signs, sparsity_score
from debrisest.roles import Keys, NonNegative, Positive, RecoveryPart

_ATTITUDES: dict[str, Callable[[Array, Array], Array]] = {"triad": triad, "wahba": wahba}
Count = Annotated[int, Field(ge=1)]
MOST_JITTER = 0.01
"""Part of a step by which an epoch may be off: a turn as small beside what a step turns."""


class SignSearch(Keys):
    """How the signs of the pieces are found: a beam over hypotheses, on the scalar part."""

    score: Literal["lasso", "sparsity"] = "lasso"
    count_weight: NonNegative = Field(1.0, description="weight of |c|_0 in the score sparsity")
    modulus_weight: NonNegative = Field(10.0, description="weight of |c|_1 in the score sparsity")
    threshold: Positive = Field(0.01, description="modulus from which a coefficient counts")
    first_pieces: Annotated[int, Field(ge=1, le=12)] = 5
    beam: Count = 2
    first_iterations: Count = 60
    iterations: Count = 8
    splitting: Positive = Field(0.1, description="as of the recovery, for the hypotheses")
    relaxation: Annotated[float, Field(gt=0, lt=2)] = 1.6

    def scorer(self) -> Callable[[Recovered], Array]:
        """Return the penalty of a hypothesis, the lower the better."""
        if self.score == "lasso":
            return lasso_score
        return lambda solution: sparsity_score(
            solution, self.count_weight, self.modulus_weight, self.threshold
        )


class BasisPursuit(RecoveryPart):
    """Attitude of each epoch from its points, signs by search, the rest by basis pursuit.

    The transform takes epochs for equidistant, so that they must be, but for a small jitter.
    """

    needs = ("measured_point", "known_point_f")
    gives = ("q_if",)
    kind: Literal["basis_pursuit"]
    attitude: Literal["triad", "wahba"]
    dictionary_ratio: Annotated[float, Field(ge=1)] = Field(
        2.0, description="atoms per sample; 1 is the plain transform"
    )
    penalty: Positive = Field(description="lambda of the lasso")
    splitting: Positive = Field(0.1, description="mu of the augmented Lagrangian, over the atoms")
    iterations: Count = 300
    relaxation: Annotated[float, Field(gt=0, lt=2)] = 1.6
    tolerance: NonNegative = 1e-3
    signs: SignSearch = SignSearch()

    def recover(self, data: Data, clock: Clock) -> Data:
        """Return raw and recovered attitude (run, time, 4) with the solver's words on it."""
        _require_even(clock)
        matrix = _ATTITUDES[self.attitude](data["known_point_f"][0], data["measured_point"])
        raw = quaternion.from_matrix(matrix)
        piece = pieces(np.isfinite(raw[..., 0]))
        raw = continuous(raw, piece)
        sign = self._signs(raw[..., 0], piece)
        solution = self._solve(_signed(raw, sign, piece))
        return {
            "raw_q_if": raw,
            "q_if": quaternion.normalize(np.moveaxis(solution.signal, 1, -1)),
            "piece": np.where(piece < 0, np.nan, piece),
            "sign": sign,
            "status": sentences(solution.status.max(axis=-1), RecoveryStatus),
            "objective": solution.objective,
            "iterations": solution.iterations,
        }

    def assess(self, data: Data) -> Data:
        """Return what the recovery says of itself, and its errors if there is a truth."""
        result: Data = {
            "coverage": np.isfinite(data["piece"]).mean(axis=-1),
            "pieces": np.isfinite(data["sign"]).sum(axis=-1),
            "solved": data["recover_status"] == RecoveryStatus.CONVERGED.sentence,
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
        }

    def _signs(self, component: Array, piece: IntArray) -> Array:
        search = self.signs
        return search_signs(
            component,
            piece,
            search.scorer(),
            ratio=self.dictionary_ratio,
            penalty=self.penalty,
            splitting=search.splitting,
            relaxation=search.relaxation,
            first=search.first_pieces,
            beam=search.beam,
            first_iterations=search.first_iterations,
            iterations=search.iterations,
        )

    def _solve(self, q: Array) -> Recovered:
        components = np.moveaxis(q, -1, 1)
        return basis_pursuit(
            components,
            np.isfinite(components),
            dictionary_length(components.shape[-1], self.dictionary_ratio),
            self.penalty,
            self.splitting,
            self.iterations,
            relaxation=self.relaxation,
            tolerance=self.tolerance,
        )


def _require_even(clock: Clock) -> None:
    if clock.jitter > MOST_JITTER:
        raise ValueError(
            f"the epochs are up to {clock.jitter:.2g} steps away from an even grid, and at most "
            f"{MOST_JITTER:g} is allowed; resample the points, or estimate from the points "
            "themselves, at their own times (problem tumbling_points)"
        )


def _signed(q: Array, sign: Array, piece: IntArray) -> Array:
    """Give each epoch's quaternion (run, time, 4) the sign of its piece."""
    if not sign.shape[-1]:
        return q
    each = np.take_along_axis(sign, np.maximum(piece, 0), axis=-1)
    return q * np.where(piece < 0, 1.0, each)[..., None]
