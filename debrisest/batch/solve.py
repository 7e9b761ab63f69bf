"""From evidence to a motion: search, judgement, and the smoother where no torque-free arc holds."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.acceptance import Fit, tested
from debrisest.batch.arc import Arc, along
from debrisest.batch.curvature import spread_of
from debrisest.batch.descent import covariance, descend
from debrisest.batch.evidence import Evidence
from debrisest.batch.holding import holding
from debrisest.batch.lasting_errors import with_lasting_errors
from debrisest.batch.local_rates import Local, local_rates
from debrisest.batch.motion import NO_COVARIANCE, Judged, Status
from debrisest.batch.observability import lost_directions, possible
from debrisest.batch.other_minima import lowest_minimum
from debrisest.batch.outliers import without_biased_points
from debrisest.batch.path import Path, path_of, unknown_path
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.search import search
from debrisest.batch.smoother import Wander, smooth, wander
from debrisest.batch.spread import Spread
from debrisest.batch.steady import nutates_plainly, turns_steadily
from debrisest.batch.windows import Growth, refitted, widened

_GATE = 25.0
_FEWEST_DOF = 30.0  # beyond the unknowns, below which the tests prove nothing


class Solution(NamedTuple):
    """What evidence gives, whatever was measured."""

    status: Status
    judged: Judged
    path: Path
    arc: Arc | None
    covariance: Array
    spread: Spread | None
    fit: Fit | None
    holds: tuple[float, float]
    noise: float
    evidence: Evidence
    local: Local | None
    wander: Wander | None


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def solve(
    evidence: Evidence,
    times: Array,
    noise_known: bool,
    wider: Evidence | None = None,
    near: Arc | None = None,
) -> Solution:
    """Return the motion at ``times (time,)``, s.

    ``wider`` is evidence that only a known motion makes useful; it joins at the end. Where an arc
    ``near`` the motion, such as that of fewer data, leads to one that stands the tests, there is
    no search. An arc that nothing can follow costs infinitely much, and is left without a warning.
    """
    if near is not None:
        growth = refitted(evidence, near)
        solution = _finished(growth, None, times, noise_known) if growth.explains else None
        if solution is not None:
            return solution
    local = local_rates(evidence.times, evidence.seen())
    if local is None:
        return _nothing(evidence, times)
    growth = search(evidence, local)
    if growth.whole and growth.fit.steady and wider is not None:
        growth = widened(growth, wider)
    solution = _finished(growth, local, times, noise_known)
    return solution or _any_motion(evidence, local, growth, times, noise_known)


def _finished(
    growth: Growth, local: Local | None, times: Array, noise_known: bool
) -> Solution | None:
    """Return the arc, less points that are elsewhere, if it stands the tests."""
    certain = True
    if growth.whole:
        growth, certain = without_biased_points(growth)
    solution = _torque_free(growth, local, times, noise_known)
    if solution is None or certain:
        return solution
    return solution._replace(status=Status.MODEL_IN_DOUBT)


def _torque_free(
    growth: Growth, local: Local | None, times: Array, noise_known: bool
) -> Solution | None:
    """Return the arc with its covariance if it stands the tests."""
    fit, evidence = growth.fit, growth.evidence
    if not (growth.whole and fit.steady):
        return None
    judged = _judged(fit, noise_known)
    noise = 1.0 if judged is Judged.CHI_SQUARE_AND_BLOCKS else float(np.sqrt(fit.excess))
    scaled = evidence if noise == 1.0 else evidence.scaled(noise)
    found = growth.found
    if noise != 1.0 or not found.settled:
        found = descend(scaled, found.arc, 10)
    linear = covariance(found.hold, evidence.unknowns_fixed)
    alone = True
    if not nutates_plainly(scaled, found.arc, linear):
        found, alone = lowest_minimum(scaled, found)
        alone = alone and not turns_steadily(scaled, found)
        linear = covariance(found.hold, evidence.unknowns_fixed)
    spread = spread_of(scaled, found, linear)
    total = spread.covariance(found.arc)
    if alone and not possible(found.arc, total):
        return None
    status = Status.ACCEPTED_IN_PART if lost_directions(total) else Status.ACCEPTED
    if not alone:
        status = Status.WITHOUT_INERTIA
    if fit.dof < _FEWEST_DOF:
        status = Status.UNTESTED
    if scaled is not evidence or found is not growth.found:
        fit = tested(scaled, found.arc)
    return Solution(
        status,
        judged,
        path_of(found.arc, spread, times),
        found.arc,
        total,
        spread,
        fit,
        growth.span,
        noise,
        _settled(scaled, found.arc),
        local,
        None,
    )


def _settled(evidence: Evidence, arc: Arc) -> Evidence:
    """Return evidence with its nuisances, if it has any, at their best for an arc."""
    if isinstance(evidence, KnownPoints):
        return evidence
    return evidence.settled(along(arc, evidence.times)[0])


def _judged(fit: Fit, noise_known: bool) -> Judged:
    if not noise_known:
        return Judged.NOISE_UNKNOWN
    return Judged.CHI_SQUARE_AND_BLOCKS if fit.noise_below else Judged.NOISE_LARGER


def _any_motion(
    evidence: Evidence, local: Local, growth: Growth, times: Array, noise_known: bool
) -> Solution:
    """Return a smoother's motion, after a pass that shows the outliers."""
    for _ in range(2):
        found = wander(evidence, local)
        path = smooth(evidence, local, found, evidence.times)
        scaled = evidence.settled(path.q).scaled(found.noise)
        kept = scaled.gated(path.q, path.rate, _GATE).scaled(1.0 / found.noise)
        if np.array_equal(kept.dof, evidence.dof):
            break
        evidence = kept
    judged = Judged.CHI_SQUARE_AND_BLOCKS if noise_known else Judged.NOISE_UNKNOWN
    if noise_known and found.noise > 1.05:
        judged = Judged.NOISE_LARGER
    path = smooth(evidence, local, found, times)
    if noise_known:
        path = with_lasting_errors(path, evidence, found.noise)
    return Solution(
        *(Status.NOT_TORQUE_FREE, judged, path, None, NO_COVARIANCE, None, growth.fit),
        *(holding(evidence, local), found.noise, evidence, local, found),
    )


def _nothing(evidence: Evidence, times: Array) -> Solution:
    """Return the attitudes of single epochs, if any."""
    path, seen = unknown_path(times), evidence.seen()
    good = np.isfinite(seen.q[:, 0]) & (not evidence.of_rate) & np.isin(evidence.times, times)
    at = np.searchsorted(times, evidence.times[good])
    path.q[at] = seen.q[good]
    path.turn_covariance[at] = np.linalg.pinv(seen.information[good], 1e-12, hermitian=True)
    span = (float(times[0]), float(times[0])) if len(times) else (np.nan, np.nan)
    judged = Judged.NOISE_UNKNOWN
    return Solution(
        *(Status.TOO_FEW, judged, path, None, NO_COVARIANCE, None, None, span, np.nan),
        *(evidence, None, None),
    )
