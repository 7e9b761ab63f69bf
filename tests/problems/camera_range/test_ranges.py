"""Ranges that are wrong, and ranges to landmarks without pixels."""

import numpy as np
import pytest

from debrisest.filters.landmark_model import points_of
from debrisest.filters.landmarks.cost import Prior, Unknowns, cost
from debrisest.filters.landmarks.growing_windows import Window, fresh, place
from debrisest.filters.verdict import Verdict

POSITION = slice(6, 9)


def position_error(case, found) -> np.ndarray:
    state = found.state[:, -1, : case.core.shape[-1]]
    return np.abs(case.model.difference(state, case.core[:, -1])[:, POSITION]).max(-1)


@pytest.mark.parametrize("hidden", [False, True])
def test_a_false_range_is_rejected_and_counted(nominal, hidden: bool) -> None:
    case, started = nominal
    common, seen = case.observed.common.copy(), case.observed.seen.copy()
    common[:2, 120] += 20.0  # m
    seen[:, 120] &= not hidden
    case = case.with_observed(case.observed._replace(common=common, seen=seen))
    found, blind = case.filtered(started), case.filtered(started, false_alarm=None)
    assert (found.counts["rejected"][:2, 120] >= 1).all()
    assert (position_error(case, found) < 0.03).all()
    assert (position_error(case, blind)[:2] > 0.1).all()
    if hidden:
        assert found.nis_dof[:2, 120].tolist() == [0, 0]


def test_true_ranges_pass_as_often_as_they_should(nominal) -> None:
    case, started = nominal
    seen = np.zeros_like(case.observed.seen)
    found = case.with_observed(case.observed._replace(seen=seen)).filtered(started)
    assert found.counts["rejected"].sum() <= 3  # of 196, with a probability of 1e-3 each


def test_false_ranges_do_not_bend_a_robust_batch(experiment) -> None:
    case = experiment(2, 102, 30)
    common = case.observed.common.copy()
    common[:, [5, 30, 55, 80]] += 3.0  # m
    started = case.with_observed(case.observed._replace(common=common)).batch(robust=True)
    assert (started.verdict == Verdict.CONSISTENT).all()
    assert np.abs(case.start_error(started)[:, POSITION]).max() < 0.1


@pytest.mark.parametrize("robust", [False, True])
def test_the_gradient_is_the_slope_of_the_cost(experiment, robust: bool) -> None:
    case = experiment(1, 30, 31, guess=0.0)
    case.observed.common[:, 4] += 0.5  # m
    at = Unknowns(
        case.model.parameters(case.core[:, 0]), case.points.copy(), np.ones((1, 11), dtype=bool)
    )
    prior, frames = Prior(at.vector, np.eye(47)[None]), np.arange(0, 10)
    found = cost(case.model, case.observed, prior, at, frames, robust)
    step = np.zeros((1, 47))
    step[0, 6:9] = [1e-5, -2e-5, 1e-5]
    up, down = (
        cost(case.model, case.observed, prior, at.moved(s), frames, robust).value
        for s in (step, -step)
    )
    np.testing.assert_allclose(up - down, -4.0 * (found.gradient * step).sum(-1), rtol=1e-3)


def test_a_range_alone_gives_a_landmark_no_place(experiment) -> None:
    case = experiment(2, 42, 32, range_to="landmark")
    seen = case.observed.seen.copy()
    seen[:, :30, 3] = [False, False, True]
    observed = case.observed._replace(seen=seen)
    mean = np.zeros((2, 47))
    at, prior = fresh(case.model, case.parameters, Prior(mean, np.tile(np.eye(47), (2, 1, 1))))
    before, _ = place(case.model, observed, at, prior, 20)
    after, _ = place(case.model, observed, at, prior, 40)
    assert not before.placed[:, 3].any()
    assert np.delete(before.placed, 3, axis=1).all()
    assert after.placed.all()


def test_a_landmark_is_inserted_by_its_pixels_only(experiment) -> None:
    case = experiment(2, 130, 33, range_to="landmark", guess=0.3)
    started = case.batch(windows=[Window(20, 1), Window(40, 1), Window(100, 2)])
    started.present[:, 3] = False
    started.covariance[:, 26:29] = started.covariance[:, :, 26:29] = 0.0
    shown, seen = case.observed.shown.copy(), case.observed.seen.copy()
    seen[:, :112, 3] = False
    seen[:, 110, 3, 2] = True
    shown[:, 110, 3] = [0.0, 0.0, np.linalg.norm(case.core[0, 110, 7:10])]
    found = case.with_observed(case.observed._replace(shown=shown, seen=seen)).filtered(started)
    assert found.counts["dropped"].tolist() == [0, 0]
    points = points_of(case.model, found.state[:, -1])
    assert np.abs(points[:, 3] - case.points[:, 3]).max() < 0.2
