"""What an estimate says of itself: tests that see what the size of the innovations does not.

Every test compares a statistic of each run with what a right model and a converged estimate give
by chance once in some ten thousand times at most. One that fails has a sentence; the worst decides.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.estimates import Estimates
from debrisest.filters.linear_algebra import solve
from debrisest.filters.rivals import DECISIVE
from debrisest.filters.status import FilterStatus, ReplayStatus
from debrisest.outcome import Outcome

_SIGMAS = 5.0
"""Whose probability, of a normal distribution, is that of a square that is too large."""
_SIGMAS_OF_SCORES = 4.0
"""Of a normal distribution, once in 16 000 times."""


_RATIO, _MOST = 10.0, 700.0
"""Of likelihoods, from which on there is doubt; and the largest logarithm that is told."""
_TOLD = 0.64
"""Part of the stated information that views must hold, so that errors are 1.25 times as large."""
_CROWDED = 0.6
"""Share of near pairs where clutter is dense in the middle; of pieces that stay it is 0.73."""
_CLAIMED = 2.0
"""Times the information that there is, above which a sigma is too small by more than 1.4."""


class Verdict(Outcome):
    """Whether the errors of a run are as large as it says; the codes are those of `doubt`."""

    CONSISTENT = 0, "consistent"
    LARGER = 1, "errors may be larger than stated"
    AMBIGUOUS = 2, "ambiguous"
    LOST = 3, "lost"


_VERDICTS = list(Verdict)


class SelfTest(NamedTuple):
    """A statistic of each run, and what it means that it is too large."""

    value: Array
    """(run,); NaN where nothing is tested."""
    limit: Array | float
    """The largest value that passes."""
    reason: str
    """With ``{value}`` and ``{limit}``, which stand for numbers such as 1.06."""
    verdict: Verdict = Verdict.LARGER
    size: Array | None = None
    """(run,); what ``{size}`` stands for."""

    @property
    def failed(self) -> BoolArray:
        """Return which runs (run,) fail."""
        return np.asarray(self.value > self.limit)

    def why(self, run: int) -> str:
        """Return the sentence of a run that fails."""
        limit = np.broadcast_to(self.limit, self.value.shape)[run]
        size = None if self.size is None else float(self.size[run])
        return self.reason.format(value=f"{self.value[run]:.3g}", limit=f"{limit:.3g}", size=size)


class Judged(NamedTuple):
    """Verdict of each run (run,) and its sentence (run,)."""

    code: IntArray
    sentence: NDArray[np.str_]


def judged(tests: Sequence[SelfTest], runs: int) -> Judged:
    """Return the worst verdict of each run, and why."""
    code = np.zeros(runs, dtype=np.int64)
    for test in tests:
        code = np.maximum(code, np.where(test.failed, test.verdict, Verdict.CONSISTENT))
    said = [_said(tests, _VERDICTS[code[run]], run) for run in range(runs)]
    return Judged(code, np.array(said))


def told(found: Estimates, tests: Sequence[SelfTest]) -> Estimates:
    """Return estimates that say how they ended, and how far they are to be trusted.

    ``doubt`` is the code of the `Verdict`; runs that did not end as they should are lost.
    """
    ended = found.status != FilterStatus.FINISHED.sentence
    ended &= found.status != ReplayStatus.CONVERGED.sentence
    verdict = judged(tests, len(ended))
    return found._replace(
        status=np.where(ended, found.status, verdict.sentence),
        counts=found.counts | {"doubt": np.where(ended, Verdict.LOST, verdict.code)},
    )


def _said(tests: Sequence[SelfTest], verdict: Verdict, run: int) -> str:
    reasons = [test.why(run) for test in tests if test.failed[run] and test.verdict == verdict]
    return ": ".join([verdict.sentence, "; ".join(reasons)]) if reasons else verdict.sentence


def cost_test(cost: Array, dof: Array | IntArray) -> SelfTest:
    """Test the cost (run,) at the estimate against its chi-square of ``dof (run,)``."""
    return SelfTest(
        cost / np.maximum(dof, 1),
        _mean_limit(dof),
        "the cost at the estimate is {value} per degree of freedom, where noise as it is said "
        "to be gives at most {limit}",
    )


def innovation_test(nis: Array, dof: Array | IntArray) -> SelfTest:
    """Test the squared innovations of a filter, ``(run, time)`` each, against their chi-square."""
    freedom = dof.sum(-1)
    return SelfTest(
        np.where(dof > 0, nis, 0.0).sum(-1) / np.maximum(freedom, 1),
        _mean_limit(freedom),
        "squared innovations are {value} of what the filter states in the mean, at most {limit} "
        "by chance",
    )


def missed_test(matched: Array, looked: Array, expected: float) -> SelfTest:
    """Test the number of views (run,) in which the target's gate was empty, of those `looked` at.

    ``expected`` is the probability that its detection is there and within the gate.
    """
    views = np.maximum(looked, 1)
    return SelfTest(
        1.0 - matched / views,
        1.0 - expected + _SIGMAS * np.sqrt(np.maximum(expected * (1.0 - expected), 1e-4) / views),
        "in a share of {value} of the views nothing lay where the target was expected, {limit} at "
        "most by chance: the track is lost, or the noise larger than given",
    )


def crowd_test(mistaken: Array, looked: Array) -> SelfTest:
    """Test how often (run,) a filter that takes the nearest point for certain is wrong in that.

    ``mistaken`` sums the probabilities of it by the distances of all points within the gate. Points
    that are not the target's do not move with it: views of which a share w is wrong tell
    (1 - w)^2 of what they are taken to tell.
    """
    return SelfTest(
        mistaken / np.maximum(looked, 1),
        1.0 - _TOLD**0.5,
        "in a share of {value} of the views the nearest point, which was taken for certain, is "
        "likely another's, and above {limit} that makes errors larger; weigh the points instead",
    )


def agitation_test(log_ratio: Array) -> SelfTest:
    """Test the ratio of likelihoods (run,) of a model with more process noise and the model's own.

    Its mean is one if the latter is right; that it is `_RATIO` is far less likely than 1 / `_RATIO`
    where what the noise does can be seen a few times only, 0.007 as counted.
    """
    return SelfTest(
        np.exp(np.minimum(log_ratio, _MOST)),
        _RATIO,
        "what is seen is {value} times as likely ({limit} by chance at most) if accelerations are "
        "larger than stated: something moves or errs in a way that the model does not have",
    )


def companion_test(near: Array, ring: Array) -> SelfTest:
    """Test whether what is beside the target stays: pairs (run,) of following frames that are near
    each other, and those in a ring of the same area, where new clutter is as frequent."""
    pairs = np.maximum(near + ring, 1)
    return SelfTest(
        near / pairs,
        _CROWDED + _SIGMAS * np.sqrt(0.25 / pairs),
        "points beside the target stay where they are from frame to frame ({value} of the close "
        "pairs, {limit} at most by chance): they are no clutter but pieces that fly along, one of "
        "which may be followed instead; track them too",
    )


def block_test(sums: Array, fitted: float) -> SelfTest:
    """Test normalised sums of residuals over blocks of time, ``(run, ...)``, NaN where nothing is.

    Each is a unit normal variable but for what the estimate has ``fitted`` of them. Slow errors far
    below the noise of an epoch show here.
    """
    flat = sums.reshape(len(sums), -1)
    dof = np.maximum(np.isfinite(flat).sum(-1) - fitted, 1.0)
    return SelfTest(
        np.nansum(flat**2, axis=-1) / dof,
        _mean_limit(dof),
        "residuals last over blocks of time: the squares of their means are {value} of what noise "
        "has, at most {limit} by chance",
    )


def parts_test(part: Array, whole: Array, part_spread: Array, whole_spread: Array) -> SelfTest:
    """Test the estimate of a part of the data against that of all (Hausman), ``(run, n)``.

    That of all is efficient, so that the covariance of the difference is the difference of the
    covariances ``(run, n, n)``; only directions in which the rest of the data tells as much again
    count.
    """
    values, vectors = np.linalg.eigh(_relative(part_spread, whole_spread))
    root = np.asarray(np.linalg.cholesky(part_spread), dtype=np.float64)
    white = solve(root, (part - whole)[..., None])[..., 0]
    along = (np.swapaxes(vectors, -1, -2) @ white[..., None])[..., 0]
    told = values < 0.5
    squares = np.where(told, along**2 / np.where(told, 1.0 - values, 1.0), 0.0).sum(-1)
    dof = told.sum(-1)
    return SelfTest(
        squares / np.maximum(dof, 1),
        _mean_limit(dof),
        "the first part of the data and all of it disagree: the squared difference is {value} of "
        "what is stated, at most {limit} by chance",
    )


def rival_test(gap: Array) -> SelfTest:
    """Test by how much the mirror's cost is higher (run,); infinite or NaN where there is none."""
    return SelfTest(
        -gap,
        -DECISIVE,
        "the motion and another one, with its depth reversed, fit the images about as well; "
        "a longer arc, or a target that turns more, is needed to tell them apart",
        Verdict.AMBIGUOUS,
    )


def score_test(value: Array, sigma: Array, reason: str, scale: float = 1.0) -> SelfTest:
    """Test a parameter that the model holds at zero (Rao): its ``value (run,)`` if it were free.

    ``reason`` may use ``{value}``, which is in sigmas, and ``{size}``, the value times ``scale``.
    """
    return SelfTest(np.abs(value) / sigma, _SIGMAS_OF_SCORES, reason, size=scale * value)


def bend_test(rise: Array) -> SelfTest:
    """Test the rise of the cost (run,) at one sigma along the widest direction: one, if even.

    Where a valley of the cost is bent, its covariance is no ellipsoid, and normalised errors are
    far larger than the errors themselves.
    """
    return SelfTest(
        rise,
        2.0,
        "one sigma along the direction that the data tell least of, the cost rises by {value} "
        "and not by 1: the errors there are correlated in another way than stated",
    )


def gauge_test(claimed: Array) -> SelfTest:
    """Test how many times as much (run,) is claimed of what nothing measures as is known of it.

    Its own sigma can be mended, but the errors of all that turns with it lie on an arc.
    """
    return SelfTest(
        claimed,
        _CLAIMED,
        "nothing measures how the body axes are turned, and {value} times as much is claimed of it "
        "as was known at the start: attitude, rate, points and inertia err together, by one turn",
    )


def lost_test(lost: BoolArray, reason: str) -> SelfTest:
    """Return the test that runs fail which have no estimate to speak of."""
    return SelfTest(lost.astype(np.float64), 0.5, reason, Verdict.LOST)


def _mean_limit(dof: Array | IntArray) -> Array:
    """Largest square per degree of freedom, (run,): of many, ``1 + 5 sqrt(2 / dof)``."""
    from scipy.special import chdtri, ndtr

    count = np.maximum(dof, 1)
    return np.asarray(chdtri(count, ndtr(-_SIGMAS)) / count)


def _relative(part: Array, whole: Array) -> Array:
    """Covariance of all in units of that of the part."""
    root = np.asarray(np.linalg.cholesky(part), dtype=np.float64)
    half = solve(root, whole)
    return np.asarray(solve(root, np.swapaxes(half, -1, -2)))
