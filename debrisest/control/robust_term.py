"""The robust term of the control law, in the ways in which its printed equation can be read.

Source: Li et al., Eqs 30 and 37: ``(I - D) k.s = F + D v + eta s``. The gain ``k`` is never formed:
its division by ``s`` is singular where the law is to settle, and only the product is needed.
"""

from typing import Literal, NamedTuple

import numpy as np

from debrisest.arrays import Array

Reading = Literal["literal", "conditional", "saturated", "sign", "none"]
"""``literal``: as printed, with the signs of F, v and s. It is smooth, but is not what the theory
asks for, where F carries the sign of s. ``conditional``: the same, with an integral in s that grows
only near the goal; in the first stage alone, as the second starts at its goal. ``sign``:
``sign(s) (F + D |v| + eta |s|) / (1 - D)``, which chatters. ``saturated``: that with a linear
stretch about s = 0. ``none``: feedback linearisation alone."""


class Gains(NamedTuple):
    """Diagonal gains of one stage, each with one number for every output."""

    proportional: Array
    """Of the error (lambda_-1): also of its integral in s."""
    damping: Array
    """Of the error's rate (lambda_0): also of the error in s."""
    robustness: Array
    """Of s (eta)."""
    boundary: Array
    """Half the width of the linear stretch of ``saturated``, in units of s."""


class Uncertainty(NamedTuple):
    """What the model is thought to be wrong by."""

    drift: float = 0.1
    """F: share of the state function."""
    gain: float = 0.4
    """D: share of the input matrix, below one."""


def robust_term(
    reading: Reading,
    feedback: Array,
    drift: Array,
    surface: Array,
    gains: Gains,
    uncertainty: Uncertainty,
) -> Array:
    """``k.s (..., n)`` of the feedback ``v``, the state function and the surface ``s (..., n)``."""
    if reading == "none":
        return np.zeros_like(feedback)
    bound = uncertainty.drift * np.abs(drift)
    share = 1.0 - uncertainty.gain
    if reading in ("literal", "conditional"):
        return (bound + uncertainty.gain * feedback + gains.robustness * surface) / share
    largest = bound + uncertainty.gain * np.abs(feedback) + gains.robustness * np.abs(surface)
    if reading == "sign":
        return np.asarray(np.sign(surface) * largest / share)
    return np.asarray(np.clip(surface / gains.boundary, -1.0, 1.0) * largest / share)
