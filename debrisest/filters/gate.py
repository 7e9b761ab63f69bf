"""Which measurements are too unlikely to be used, and when to doubt the filter instead of them."""

from typing import NamedTuple

import numpy as np
from scipy.special import gammainccinv

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.covariance import solve
from debrisest.filters.missing import drop_missing


class Gate(NamedTuple):
    """Settings of an innovation gate with a detector of lock-outs.

    The default limit is 4.9 sigma for a single component: outliers of vision lie far beyond, and
    the innovations of a filter that has not converged yet have wider tails than the Gaussian.
    """

    false_alarm: float = 1e-6
    """Probability of rejecting a good group, the tail of the chi-square distribution."""
    lockout_share: float = 0.5
    """A run that rejects more than this share of its measured groups may be lost itself."""
    lockout_epochs: int = 3
    """After so many such measured epochs on end, the next such one is let in as a whole."""


class Verdict(NamedTuple):
    """What a gate says of one epoch."""

    accepted: BoolArray
    """Components to use, (run, m)."""
    reopened: BoolArray
    """Runs whose gate was opened, (run,)."""


class Gatekeeper:
    """Applies a `Gate` epoch by epoch, and remembers for how long each run has been locked out."""

    def __init__(self, gate: Gate, groups: tuple[int, ...] | None, runs: int, components: int):
        _require_settings(gate, groups, components)
        labels = np.arange(components) if groups is None else np.array(groups, dtype=np.int64)
        _, self._group = np.unique(labels, return_inverse=True)
        self._members, self._real = _members(self._group)
        freedom = np.arange(1, self._members.shape[1] + 1)
        limits = 2.0 * gammainccinv(0.5 * freedom, gate.false_alarm)
        self._limits = np.concatenate([[np.inf], limits])
        self._gate = gate
        self._streak = np.zeros(runs, dtype=np.int64)

    def judge(self, measured: BoolArray, innovation: Array, total: Array) -> Verdict:
        """Judge groups by their own innovation `(run, m)` and its covariance `(run, m, m)`."""
        present = measured[:, self._members] & self._real
        freedom = present.sum(-1)
        passed = self._squares(present, innovation, total) <= self._limits[freedom]
        reopened = self._locked_out((~passed).sum(-1), (freedom > 0).sum(-1))
        return Verdict(measured & (passed[:, self._group] | reopened[:, None]), reopened)

    def _squares(self, present: BoolArray, innovation: Array, total: Array) -> Array:
        """Normalised innovation squared of every group, (run, group); NaN if it has none."""
        nu = innovation[:, self._members]
        block = total[:, self._members[:, :, None], self._members[:, None, :]]
        nu, _, block = drop_missing(present, nu, nu[..., None, :], block)
        size = nu.shape[-1]
        solved = solve(block.reshape(-1, size, size), nu.reshape(-1, size, 1))
        return np.asarray((nu * solved.reshape(nu.shape)).sum(-1))

    def _locked_out(self, rejected: IntArray, judged: IntArray) -> BoolArray:
        suspect = rejected > self._gate.lockout_share * judged
        reopened: BoolArray = suspect & (self._streak >= self._gate.lockout_epochs)
        self._streak = np.where(judged == 0, self._streak, (self._streak + 1) * suspect)
        self._streak[reopened] = 0
        return reopened


def inflation(verdict: Verdict, innovation: Array, total: Array, noise: Array) -> Array:
    """Factor (run,) of the predicted covariance that explains the innovations of a reopened run.

    Opened alone, the gate of a filter that is sure of a wrong state would let in data that hardly
    move it. The factor matches the sum of the squared innovations, each by its own scale, to what
    is expected of them: the fading factor of strong tracking filters. It is one for other runs.
    """
    expected, own = np.diagonal(total, 0, -2, -1), np.diagonal(noise, 0, -2, -1)
    weight = np.where(verdict.accepted, 1.0 / expected, 0.0)
    surplus = (weight * (innovation**2 - own)).sum(-1)
    factor = surplus / (weight * (expected - own)).sum(-1)
    return np.where(verdict.reopened & np.isfinite(factor), np.maximum(factor, 1.0), 1.0)


def _members(group: IntArray) -> tuple[IntArray, BoolArray]:
    """Components of each group (group, largest size), and which of them are not padding."""
    sizes = np.bincount(group)
    real = np.arange(sizes.max()) < sizes[:, None]
    members = np.zeros(real.shape, dtype=np.int64)
    members[real] = np.argsort(group, kind="stable")
    return members, real


def _require_settings(gate: Gate, groups: tuple[int, ...] | None, components: int) -> None:
    if not (0 < gate.false_alarm < 1 and 0 <= gate.lockout_share < 1 and gate.lockout_epochs >= 1):
        raise ValueError(
            "a gate needs a false alarm probability between 0 and 1, a lock-out share "
            f"below 1 and at least one lock-out epoch, not {tuple(gate)}"
        )
    if groups is not None and len(groups) != components:
        raise ValueError(f"{components} components need as many gate groups, not {len(groups)}")
