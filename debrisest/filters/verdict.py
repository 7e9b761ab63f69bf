"""How far the errors of a run are to be trusted, by the tests that it passes; the worst decides."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.estimates import Estimates
from debrisest.filters.status import FilterStatus, ReplayStatus
from debrisest.outcome import Outcome


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
