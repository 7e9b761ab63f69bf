"""Probabilities that a detection is the target's, for one track at a time."""

from collections.abc import Callable
from math import gamma, pi
from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array, IntArray


def unit_ball(d: int) -> float:
    """Volume of the unit ball of d dimensions, C_d."""
    return float(pi ** (0.5 * d) / gamma(0.5 * d + 1.0))


def inverse_unit_ball(d: int) -> float:
    """1 / C_d, which Li et al. (Eq. 13) have in its place: b is too large by C_d^2, 9.9 for two."""
    return 1.0 / unit_ball(d)


class Validation(NamedTuple):
    """Which detections are considered at all, and how likely the target's is among them."""

    gate: float = 9.21
    """Largest squared distance d^T S^-1 d of a detection, gamma; of two components 99 % pass."""
    detection_probability: float = 0.99
    """That the target gives a detection, P_D."""
    gate_probability: float | None = None
    """That the target's detection passes the gate, P_G; without it, what chi-square says."""
    ball: Callable[[int], float] = unit_ball
    """Volume of the gate by d, for |S| = gamma = 1, by which clutter is spread in it."""
    dimension: int | None = None
    """What the weight of absence takes d for, n_z; without it, what it is."""

    def passing(self, d: int) -> float:
        """Return P_G of a detection of d components."""
        given = self.gate_probability
        return float(scipy.special.gammainc(0.5 * d, 0.5 * self.gate)) if given is None else given

    def checked(self) -> "Validation":
        """Return the settings if they make sense."""
        if not self.gate > 0.0 or not 0.0 < self.detection_probability <= 1.0:
            raise ValueError(
                "a positive gate and a detection probability above 0, at most 1 are needed, "
                f"not {self.gate} and {self.detection_probability}"
            )
        if self.gate_probability is not None and not 0.0 < self.gate_probability <= 1.0:
            raise ValueError(f"a gate probability above 0, at most 1, not {self.gate_probability}")
        return self


class Weights(NamedTuple):
    """Relative weights of the hypotheses of a track, the largest of them 1."""

    present: Array
    """Detection i is the target's, (..., detection)."""
    absent: Array
    """None is, (...)."""


def absence_weight(count: IntArray, validation: Validation, d: int) -> Array:
    """Weight b of "none of `count` (...) validated detections is the target's".

    Relative to exp(-g_i / 2) of a detection at the squared distance g_i. With a clutter density of
    as many as were validated over the volume of the gate, C_d gamma^(d/2) |S|^(1/2) with the unit
    ball's volume C_d, it is (Bar-Shalom and Fortmann 1988)

        b = (2 pi / gamma)^(d/2) m (1 / C_d) (1 - P_D P_G) / P_D .
    """
    detected = validation.detection_probability
    d = validation.dimension or d
    missed = (1.0 - detected * validation.passing(d)) / detected
    return np.asarray(
        count * ((2.0 * pi / validation.gate) ** (0.5 * d) * missed / validation.ball(d))
    )


def weights(distance: Array, validation: Validation, d: int) -> Weights:
    """Weights by squared distances (..., detection), infinite where nothing was validated.

    Where nothing was, only absence is left, whatever the formula for b says of m = 0.
    """
    count = np.isfinite(distance).sum(-1)
    absence = np.where(count > 0, absence_weight(count, validation, d), 1.0)
    nearest = np.min(distance, axis=-1, initial=np.inf)
    with np.errstate(divide="ignore"):
        log_present, log_absent = -0.5 * distance, np.log(absence)
    largest = np.maximum(-0.5 * nearest, log_absent)
    return Weights(np.exp(log_present - largest[..., None]), np.exp(log_absent - largest))


def probabilistic(distance: Array, validation: Validation, d: int) -> Array:
    """Probability of each detection (..., detection) to be the target's: beta_i (Li, Eq. 10)."""
    present, absent = weights(distance, validation, d)
    return np.asarray(present / (absent + present.sum(-1))[..., None])


def nearest(distance: Array) -> Array:
    """One for the nearest detection (..., detection) that was validated, zero for the others."""
    if distance.shape[-1] == 0:
        return np.zeros(distance.shape)
    first = np.arange(distance.shape[-1]) == np.argmin(distance, axis=-1)[..., None]
    return np.where(first & np.isfinite(distance), 1.0, 0.0)
