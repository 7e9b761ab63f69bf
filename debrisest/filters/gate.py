"""Which measurements are too unlikely to be used, and when to doubt the filter instead of them."""

from copy import copy
from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.linear_algebra import solve
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
    """After so many such measured epochs on end, the gate opens for the next such one."""


class Verdict(NamedTuple):
    """What a gate says of one epoch."""

    accepted: BoolArray
    """Components to use, (run, m)."""
    reopened: BoolArray
    """Runs whose gate was opened, (run,)."""
    factor: Array
    """By how much the predicted covariance of a reopened run is too small, 1 of others, (run,)."""


class Gatekeeper:
    """Applies a `Gate` epoch by epoch, and remembers for how long each run has been locked out.

    Opened alone, the gate of a filter that is sure of a wrong state would let in data that hardly
    move it, and with them every outlier. So the prediction of such a run is doubted: its covariance
    is multiplied until it explains the typical rejected group, and the gate, as wide as that makes
    it, judges the epoch again; if most is rejected even so, everything is let in. (The factor is
    that of strong tracking filters, of the median group in place of the sum.) But `doubted` lets no
    sigma grow beyond that of the start: directions that the data never informed would carry a
    nonlinear filter away. A jump much larger than the start's sigma takes several openings.
    """

    def __init__(self, gate: Gate, groups: tuple[int, ...] | None, start: Array, components: int):
        _require_settings(gate, groups, components)
        labels = np.arange(components) if groups is None else np.array(groups, dtype=np.int64)
        _, self._group = np.unique(labels, return_inverse=True)
        self._members, self._real = _members(self._group)
        self._limits = chi_square_limits(gate.false_alarm, self._members.shape[1])
        self._gate = gate
        self._streak = np.zeros(len(start), dtype=np.int64)
        self._start = np.diagonal(start, 0, -2, -1)

    def judge(self, measured: BoolArray, innovation: Array, total: Array, noise: Array) -> Verdict:
        """Judge groups by their own innovations.

        `total` (run, m, m) is the covariance of `innovation` (run, m), of which `noise` (m, m) is
        the measurement's share.
        """
        present = measured[:, self._members] & self._real
        limits = self._limits[present.sum(-1)]
        squares = self._squares(present, innovation, total)
        passed = squares <= limits
        judged = present.any(-1).sum(-1)
        reopened = self._locked_out((~passed).sum(-1), judged)
        factor = np.ones(len(measured))
        if reopened.any():
            part = present[reopened], innovation[reopened], total[reopened]
            factor[reopened] = _median(self._needed(*part, noise), ~passed[reopened])
            widened = noise + factor[reopened, None, None] * (part[2] - noise)
            wider = self._squares(*part[:2], widened) <= limits[reopened]
            shut = self._suspect((~wider).sum(-1), judged[reopened])
            passed[reopened] = wider | shut[:, None]
        return Verdict(measured & passed[:, self._group], reopened, factor)

    def of(self, runs: IntArray) -> "Gatekeeper":
        """Return the keeper of some runs, with what it remembers of them."""
        part = copy(self)
        part._streak, part._start = self._streak[runs], self._start[runs]
        return part

    def doubted(self, covariance: Array, factor: Array) -> Array:
        """Predicted covariance (run, n_e, n_e) times `factor`, in no direction above the start."""
        headroom = self._start / np.diagonal(covariance, 0, -2, -1)
        scale = np.sqrt(np.maximum(np.fmin(factor[:, None], headroom), 1.0))
        return np.asarray(scale[:, :, None] * covariance * scale[:, None])

    def _squares(self, present: BoolArray, innovation: Array, total: Array) -> Array:
        """Normalised innovation squared of every group, (run, group)."""
        nu = innovation[:, self._members]
        block = total[:, self._members[:, :, None], self._members[:, None, :]]
        return group_squares(present, nu, block)

    def _needed(self, present: BoolArray, innovation: Array, total: Array, noise: Array) -> Array:
        """Factor of P with which a group's squares, each by its own scale, are as expected."""
        expected, own = np.diagonal(total, 0, -2, -1), np.diagonal(noise)
        found, predicted = (innovation**2 - own) / expected, (expected - own) / expected
        sums = [
            np.where(present, share[:, self._members], 0.0).sum(-1) for share in (found, predicted)
        ]
        return np.asarray(sums[0] / sums[1])

    def _suspect(self, rejected: IntArray, judged: IntArray) -> BoolArray:
        return rejected > self._gate.lockout_share * judged

    def _locked_out(self, rejected: IntArray, judged: IntArray) -> BoolArray:
        suspect = self._suspect(rejected, judged)
        reopened: BoolArray = suspect & (self._streak >= self._gate.lockout_epochs)
        self._streak = np.where(judged == 0, self._streak, (self._streak + 1) * suspect)
        self._streak[reopened] = 0
        return reopened


def chi_square_limits(false_alarm: float, size: int) -> Array:
    """Limits (size + 1,) of the squares of groups of 0 to `size` components; infinite for 0."""
    dof = np.arange(1, size + 1)
    return np.concatenate([[np.inf], 2.0 * scipy.special.gammainccinv(0.5 * dof, false_alarm)])


def group_squares(present: BoolArray, innovation: Array, total: Array) -> Array:
    """Normalised innovation squared (...) of groups (..., size), total (..., size, size)."""
    nu, _, block = drop_missing(present, innovation, innovation[..., None, :], total)
    return np.asarray((nu * solve(block, nu[..., None])[..., 0]).sum(-1))


def _median(needed: Array, rejected: BoolArray) -> Array:
    """Upper median of the rejected groups (run,), at least one; one where it is not finite."""
    ordered = np.sort(np.where(rejected, needed, np.nan), axis=-1)
    middle = np.isfinite(ordered).sum(-1, keepdims=True) // 2
    factor = np.take_along_axis(ordered, middle, axis=-1)[:, 0]
    return np.where(np.isfinite(factor), np.maximum(factor, 1.0), 1.0)


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
