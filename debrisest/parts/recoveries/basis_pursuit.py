"""Recovery of the quaternion: signs of the pieces by search, the rest by basis pursuit."""

from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data, IntArray
from debrisest.attitude import quaternion
from debrisest.outcome import sentences
from debrisest.parts.recoveries.attitude import AttitudeRecovery
from debrisest.parts.recoveries.pursuit import Count, PursuitKeys
from debrisest.recovery.basis_pursuit import Recovered, RecoveryStatus
from debrisest.recovery.exact_recovery import exact_recovery_coefficient
from debrisest.recovery.hypotheses import Hypotheses
from debrisest.recovery.score import lasso_score, sparsity_score
from debrisest.recovery.signs import search_signs
from debrisest.roles import Keys, NonNegative, Positive


class SignSearch(Keys):
    """How the signs of the pieces are found: a beam over hypotheses, on the scalar part."""

    score: Literal["lasso", "sparsity"] = "lasso"
    """What the believed hypothesis has the least of: the lasso objective, or `count_weight` times
    the number of non-zero coefficients plus `modulus_weight` times their 1-norm."""
    count_weight: NonNegative = 1.0
    """Weight of the number of non-zero coefficients in the score `sparsity`."""
    modulus_weight: NonNegative = 10.0
    """Weight of the coefficients' 1-norm in the score `sparsity`."""
    threshold: Positive = 0.01
    """Modulus from which a coefficient counts as non-zero (`sparsity`)."""
    first_pieces: Annotated[int, Field(ge=1, le=12)] = 5
    """Pieces of which all signs are tried."""
    beam: Count = 2
    """Hypotheses that are kept."""
    first_iterations: Count = 60
    """Iterations for the first pieces."""
    iterations: Count = 8
    """Iterations for each further piece."""
    splitting: Positive = 0.1
    """As of the recovery, for the hypotheses: the augmented Lagrangian's parameter."""
    relaxation: Annotated[float, Field(gt=0, lt=2)] = 1.6
    """As of the recovery, for the hypotheses: 1 is the plain iteration."""
    keep_hypotheses: bool = False
    """Keep signs, penalties and signals that are tried for the first pieces and for the next one;
    `plot` draws them."""

    def scorer(self) -> Callable[[Recovered], Array]:
        """Return the penalty of a hypothesis, the lower the better."""
        if self.score == "lasso":
            return lasso_score
        return lambda solution: sparsity_score(
            solution, self.count_weight, self.modulus_weight, self.threshold
        )


class BasisPursuit(PursuitKeys, AttitudeRecovery):
    """Attitude of each epoch from its points, signs by search, the rest by basis pursuit."""

    version = 2
    finished = RecoveryStatus.CONVERGED
    kind: Literal["basis_pursuit"]
    signs: SignSearch = SignSearch()
    """Search of the signs of the pieces."""
    exact_recovery: bool = False
    """Compute the exact recovery coefficient of the scalar part's lines, which takes a while."""

    def recover_attitude(self, matrix: Array, raw: Array, piece: IntArray, data: Data) -> Data:
        """Return the quaternion's components, recovered with the signs that were found."""
        tried = self._hypotheses(piece) if self.signs.keep_hypotheses else None
        sign = self._signs(raw[..., 0], piece, tried)
        solution = self.pursue(_signed(raw, sign, piece))
        coefficient = self._coefficient(solution, piece) if self.exact_recovery else {}
        return coefficient | {
            "q_if": quaternion.normalize(np.moveaxis(solution.signal, 1, -1)),
            "sign": sign,
            "status": sentences(solution.status.max(axis=-1), RecoveryStatus),
            "objective": solution.objective,
            "iterations": solution.iterations,
            **({} if tried is None else _kept(tried)),
        }

    def _coefficient(self, solution: Recovered, piece: IntArray) -> Data:
        lines = solution.coefficients[:, 0]
        found = exact_recovery_coefficient(lines, piece >= 0, solution.length)
        return {"exact_recovery_gap": 1.0 - found}

    def assess(self, data: Data) -> Data:
        """Return what all recoveries tell, and the coefficient if it was asked for."""
        told = {name: data[name] for name in ("exact_recovery_gap",) if name in data}
        return super().assess(data) | told

    def _hypotheses(self, piece: IntArray) -> Hypotheses:
        """Room for the first pieces with all signs, and for one more piece of the best."""
        search, pieces = self.signs, int(piece.max(initial=-1)) + 1
        first = 2 ** (min(search.first_pieces, max(pieces, 1)) - 1)
        most = first + 2 * min(search.beam, first)
        return Hypotheses(len(piece), most, pieces, piece.shape[-1])

    def _signs(self, component: Array, piece: IntArray, tried: Hypotheses | None) -> Array:
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
            watch=tried,
        )


def _kept(tried: Hypotheses) -> Data:
    return {
        "hypothesis_sign": tried.sign,
        "hypothesis_score": tried.score,
        "hypothesis_q0": tried.signal,
    }


def _signed(q: Array, sign: Array, piece: IntArray) -> Array:
    """Give each epoch's quaternion (run, time, 4) the sign of its piece."""
    if not sign.shape[-1]:
        return q
    each = np.take_along_axis(sign, np.maximum(piece, 0), axis=-1)
    return q * np.where(piece < 0, 1.0, each)[..., None]
