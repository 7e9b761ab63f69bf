"""Points of the model that are not where the model has them.

No chi-square sees a point that is off by one sigma, but the mean of its residuals in body axes
does.
"""

from dataclasses import replace

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.batch.acceptance import LEAST_NOISE, tested
from debrisest.batch.arc import Arc, along
from debrisest.batch.descent import descend
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.windows import Growth

_LIMIT = 6.0  # sigmas of the mean
_SUSPECTS = 3
_FEWEST_POINTS = 4
_GATES = (60.0, 25.0)


def without_biased_points(growth: Growth) -> tuple[Growth, bool]:
    """Return the fit without points whose mean residual is off, and whether these are certain.

    They are not if leaving out another point would do as well. Of a known body only.
    """
    evidence, certain = growth.evidence, True
    while isinstance(evidence, KnownPoints):
        bias = mean_residuals(evidence, growth.found.arc, growth.fit.excess)
        present = int(np.sum(evidence.tracks.weight.any(axis=0)))
        if bias.max(initial=0.0) < _LIMIT or present < _FEWEST_POINTS:
            break
        suspects = np.argsort(-bias)[:_SUSPECTS]
        trials = [_refitted(growth, evidence, int(suspect)) for suspect in suspects]
        growth, evidence, _ = min(trials, key=lambda trial: trial[2])
        certain = certain and sum(trial[2] < _LIMIT for trial in trials) <= 1
    return growth, certain


def mean_residuals(evidence: KnownPoints, arc: Arc, excess: float) -> Array:
    """Return the mean residual of each point in body axes (feature,), in its own sigmas.

    ``excess`` is the variance of the noise in units of the one given.
    """
    q = along(arc, evidence.times)[0]
    total, variance = (_by_loops if compiled.available() else _by_numpy)(evidence, q)
    variance = variance * max(excess, LEAST_NOISE)
    return np.asarray(total / np.sqrt(np.maximum(variance, np.finfo(float).tiny)))


def _by_numpy(evidence: KnownPoints, q: Array) -> tuple[Array, Array]:
    """Length and variance (feature,) of the sums of weighted residuals in body axes."""
    residual = np.nan_to_num(evidence.residuals(q)) @ quaternion.to_matrix(q)
    weight = evidence.tracks.weight
    share = weight / np.maximum(weight.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    total = np.linalg.norm(np.sum(weight[..., None] * residual, axis=0), axis=-1)
    return np.asarray(total), np.asarray(np.sum(weight * (1.0 - share), axis=0))


def _by_loops(evidence: KnownPoints, q: Array) -> tuple[Array, Array]:
    """The same by compiled loops."""
    from debrisest.batch.known_points_loops import mean_residuals

    return mean_residuals(*evidence.for_loops, np.ascontiguousarray(q.T))


def _refitted(
    growth: Growth, evidence: KnownPoints, suspect: int
) -> tuple[Growth, KnownPoints, float]:
    """Return the fit without a point, what it is made of, and the largest bias left."""
    column = np.arange(evidence.tracks.weight.shape[1]) == suspect
    kept = replace(evidence, tracks=evidence.tracks.without(column))
    kept = kept.within(kept.dof > 0.0)
    arc = growth.found.arc
    for limit in _GATES:
        found = descend(kept, arc, 12)
        arc = found.arc
        kept = kept.gated(*along(arc, kept.times), limit)
    found = descend(kept, arc, 12)
    fit = tested(kept, found.arc)
    refitted = growth._replace(found=found, fit=fit, evidence=kept)
    return refitted, kept, float(mean_residuals(kept, found.arc, fit.excess).max(initial=0.0))
