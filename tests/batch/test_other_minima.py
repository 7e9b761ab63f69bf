"""An inertia is claimed only where no other one explains the data as well."""

import numpy as np

from debrisest.batch.arc import Arc
from debrisest.batch.descent import PRIOR_SIGMA, descend
from debrisest.batch.estimate import estimate_from_points
from debrisest.batch.motion import Status
from debrisest.batch.observability import inertia_directions
from debrisest.batch.other_minima import lowest_minimum
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.tracks import tracks
from debrisest.dynamics import log_inertia


def evidence_and_truth(truth, model, seed=3):
    points = truth.points(np.random.default_rng(seed), 0.05)
    middle = len(truth.times) // 2
    logs = log_inertia.log_ratios(truth.inertia)
    arc = Arc(float(truth.times[middle]), truth.q[middle], truth.rate[middle], logs)
    return KnownPoints(tracks(truth.times, points, 0.05), model), arc


def test_a_descent_that_was_stuck_is_left(body_of, box) -> None:
    truth = body_of(np.arange(0.0, 150.0), [2.0, 9.0, 1.0], [1.0, 0.9, 0.8])
    evidence, arc = evidence_and_truth(truth, box)
    stuck = descend(evidence, arc._replace(log_inertia=np.array([0.4, -0.5, 0.6, 0.5, -0.4])), 3)
    best, _ = lowest_minimum(evidence, stuck)
    assert best.chi2 < stuck.chi2 - 25.0
    assert abs(best.chi2 - descend(evidence, arc, 50).chi2) < 1.0


def test_a_nutation_that_shows_leaves_one_inertia(body_of, box) -> None:
    truth = body_of(np.arange(0.0, 150.0), [4.0, -3.0, 5.0], [1.0, 0.8, 0.55])
    evidence, arc = evidence_and_truth(truth, box)
    best, alone = lowest_minimum(evidence, descend(evidence, arc, 50))
    assert alone
    assert np.abs(best.arc.log_inertia - arc.log_inertia).max() < 0.05


def test_an_almost_spherical_body_is_accepted_without_inertia(body_of, box) -> None:
    """The best of all nutations that fit the noise may be one that no body has."""
    truth = body_of(np.arange(0.0, 300.0), [0.5, -0.7, 0.6], [1.0, 1.001, 0.9995])
    for seed in range(2):
        points = truth.points(np.random.default_rng(seed), 0.09)
        motion = estimate_from_points(truth.times, points, 0.09)
        assert motion.status is Status.WITHOUT_INERTIA
        assert np.allclose(inertia_directions(motion.claimed)[0], PRIOR_SIGMA)
