"""A cost of two minima: the replay ends in the lower one, or says that it cannot tell."""

import numpy as np
import pytest

from debrisest.filters.replay.replay import replay
from debrisest.filters.replay.self_tests import self_tests
from debrisest.filters.rivals import GIVEN_UP
from debrisest.filters.verdict import Verdict, judged
from tests.filters.constants import constants

RUNS, EPOCHS = 40, 30
SIGMA = np.array([0.01, 1.0])
SHOWN = 0.3
"""Of the number whose sign the first row hides, in the second."""


def square(
    shown=SHOWN,
    mirror=lambda state: -state,
    start=lambda prior, shown, epoch: prior,
    shape=lambda x: (x**2, 2.0 * x),
):
    """A constant whose square is measured well, and itself badly."""

    def rows(states, sensitivity, first, epochs):
        value, slope = shape(states)
        both = np.concatenate([value, shown * states], -1)
        return both, np.stack([slope, np.full_like(slope, shown)], -2)

    return constants(rows, SIGMA, ("a",), start, mirror=mirror)


def data(shown=SHOWN, seed=0, prior_sigma=3.0):
    rng = np.random.default_rng(seed)
    truth = rng.choice([-1.0, 1.0], (RUNS, 1)) * rng.uniform(1.5, 3.0, (RUNS, 1))
    exact = np.concatenate([truth**2, shown * truth], -1)[:, None]
    measured = exact + SIGMA * rng.normal(size=(RUNS, EPOCHS, 2))
    prior = np.abs(truth) + 0.1 * rng.normal(size=(RUNS, 1))
    return truth, prior, np.full((RUNS, 1, 1), prior_sigma**2), measured


def least(prior, covariance, measured, shown=SHOWN):
    """The state of least cost (run,) and that of its sign reversed, on a fine grid."""
    grid = np.linspace(-4.0, 4.0, 80_001)
    where, gap = np.empty(RUNS), np.empty(RUNS)
    for run in range(RUNS):
        cost = (grid - prior[run]) ** 2 / covariance[run, 0, 0]
        for row, value in enumerate((grid**2, shown * grid)):
            seen = measured[run, :, row] / SIGMA[row]
            cost = (
                cost + len(seen) * (value / SIGMA[row]) ** 2 - 2 * value / SIGMA[row] * seen.sum()
            )
        sides = [cost[grid < 0.0].min(), cost[grid > 0.0].min()]
        where[run], gap[run] = grid[cost.argmin()], abs(sides[1] - sides[0])
    return where, gap


def test_it_ends_in_the_lower_of_two_minima_and_says_by_how_much() -> None:
    truth, *known = data()
    found = replay(square(), *known)
    where, gap = least(*known)
    np.testing.assert_allclose(found.state[:, -1, 0], where, atol=2e-3)
    told = found.counts["rival_excess"][:, -1]
    np.testing.assert_allclose(told[gap < 90.0], gap[gap < 90.0], atol=0.3)
    alone = replay(square(mirror=None), *known).state[:, -1]
    assert (np.sign(alone) != np.sign(truth)).mean() > 0.3


@pytest.mark.parametrize(("shown", "ambiguous"), [(0.02, True), (2.0, False)])
def test_what_is_not_decided_is_told(shown: float, ambiguous: bool) -> None:
    _, *known = data(shown)
    model = square(shown)
    verdict = judged(self_tests(model, *known, replay(model, *known)), RUNS)
    assert (verdict.code == (Verdict.AMBIGUOUS if ambiguous else Verdict.CONSISTENT)).all()
    assert all(("depth reversed" in said) == ambiguous for said in verdict.sentence)


def test_outliers_leave_each_solution_its_own_weights() -> None:
    truth, prior, covariance, measured = data(2.0, seed=1)
    measured[:, 4::9] += 300.0 * SIGMA * np.random.default_rng(2).normal(size=(RUNS, 3, 2))
    found = replay(square(2.0), prior, covariance, measured, gate=True)
    np.testing.assert_allclose(found.state[:, -1], truth, atol=0.02)


def test_what_one_frame_tells_has_no_rival_left() -> None:
    truth, *known = data(shown=40.0)
    found = replay(square(40.0), *known)
    assert not (found.counts["rival_excess"] < GIVEN_UP).any()
    np.testing.assert_allclose(found.state[:, -1], truth, atol=0.01)


def test_the_prior_competes_where_the_first_guess_leads_elsewhere() -> None:
    """Of ``(a^2 - 4)^2`` the first guess lies in the valley beyond 2, whose mirror is no better."""
    rng = np.random.default_rng(3)
    truth, shown = rng.uniform(1.0, 1.6, (RUNS, 1)), 0.6
    model = square(
        shown,
        start=lambda prior, shown, epoch: np.sqrt(8.0 - prior**2),
        shape=lambda x: ((x**2 - 4.0) ** 2, 4.0 * x * (x**2 - 4.0)),
    )
    exact = np.concatenate([(truth**2 - 4.0) ** 2, shown * truth], -1)[:, None]
    measured = exact + SIGMA * rng.normal(size=(RUNS, EPOCHS, 2))
    prior = truth + 0.1 * rng.normal(size=(RUNS, 1))
    covariance = np.full((RUNS, 1, 1), 0.2**2)
    found = replay(model, prior, covariance, measured)
    np.testing.assert_allclose(found.state[:, -1], truth, atol=0.01)
    alone = replay(model._replace(mirror=None), prior, covariance, measured)
    assert (alone.state[:, -1] > 2.0).all()


def test_a_run_does_not_depend_on_those_beside_it() -> None:
    _, *known = data()
    whole, some = replay(square(), *known), np.arange(3, RUNS, 5)
    part = replay(square(), *(array[some] for array in known))
    np.testing.assert_array_equal(part.state, whole.state[some])
