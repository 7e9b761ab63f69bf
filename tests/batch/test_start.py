"""Local rates and the inertia from the conservation of angular momentum."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.batch.arc import INERTIA, Arc
from debrisest.batch.attitudes import Attitudes
from debrisest.batch.descent import NOTHING_ELSE, Prior, descend
from debrisest.batch.local_rates import local_rates
from debrisest.batch.momentum_start import inertia_start
from debrisest.batch.starts import Start, starts
from debrisest.batch.windows import grow, refitted
from debrisest.dynamics import log_inertia


def evidence_of(truth, sigma, seed=0):
    rng = np.random.default_rng(seed)
    turns = Rotation.from_rotvec(sigma * rng.normal(size=(len(truth.times), 3)))
    q = (turns * truth.attitude).as_quat(scalar_first=True)
    return Attitudes(truth.times, q, np.tile(np.eye(3) / sigma**2, (len(q), 1, 1)))


def local_of(truth, sigma, seed=0):
    return local_rates(truth.times, evidence_of(truth, sigma, seed).seen())


def test_rates_of_windows(tumbling) -> None:
    local = local_of(tumbling, 0.01)
    at = np.searchsorted(tumbling.times, local.time)
    error = local.rate - tumbling.rate[at]
    solved = np.linalg.solve(local.covariance, error[..., None])[..., 0]
    assert np.median(np.sum(solved * error, axis=-1)) < 2.5 * 2.37
    assert 0.6 < local.noise < 1.2


def test_momentum_tells_the_inertia(tumbling) -> None:
    """Within a third of the way from a sphere, which is where a start without it would be."""
    found = inertia_start(local_of(tumbling, 0.003))
    error = found.centre - log_inertia.log_ratios(tumbling.inertia)
    assert np.linalg.norm(error) < np.linalg.norm(error - found.centre) / 3.0
    assert error @ found.information @ error < 25.0
    assert np.sqrt(np.linalg.inv(found.information).trace()) < 0.5


def test_momentum_of_a_steady_spin_claims_nothing_of_what_it_does_not_show(body_of) -> None:
    spin = inertia_start(
        local_of(body_of(np.arange(400.0), [0.0, 0.0, 3.0], [0.5, 0.8, 1.0]), 0.003)
    )
    sigma = np.sqrt(np.linalg.eigvalsh(np.linalg.inv(spin.information)))
    assert np.sum(sigma > 0.3) == 3


def test_start_is_that_of_a_body(tumbling) -> None:
    moments = np.linalg.eigvalsh(log_inertia.inertia(inertia_start(local_of(tumbling, 0.3)).centre))
    assert moments[0] > 0.0
    assert moments[2] < 1.15 * (moments[0] + moments[1])


def test_too_few_attitudes_give_none(tumbling) -> None:
    q = tumbling.q[:5]
    assert (
        local_rates(
            tumbling.times[:5], Attitudes(tumbling.times[:5], q, np.zeros((5, 3, 3))).seen()
        )
        is None
    )


def middle_of(truth, log_ratios) -> Arc:
    return Arc(float(truth.times[200]), truth.q[200], truth.rate[200], log_ratios)


def test_what_holds_a_start_is_let_go_in_the_end(tumbling) -> None:
    evidence = evidence_of(tumbling, 0.01)
    true = log_inertia.log_ratios(tumbling.inertia)
    wrong = Prior(true + 0.03, np.eye(5) / 0.03**2)
    growth = grow(evidence, Start(middle_of(tumbling, wrong.centre), wrong), 10.0)
    best = refitted(evidence, middle_of(tumbling, true)).found
    assert growth.explains
    gap = growth.found.arc.log_inertia - best.arc.log_inertia
    assert gap @ best.hold[INERTIA, INERTIA] @ gap < 0.1**2


@pytest.mark.parametrize(("held", "apart"), [(False, False), (True, True)])
def test_starts_stay_apart_in_windows_too_short_to_show_the_inertia(tumbling, held, apart) -> None:
    """Free descents of a short window end at one place, so that ten starts are worth one."""
    near = np.abs(tumbling.times - tumbling.times[200]) < 10.0
    short = evidence_of(tumbling, 0.01).within(near)
    guesses = [start.held for start in list(starts(local_of(tumbling, 0.01)))[-10::2]]
    ends = [
        descend(short, middle_of(tumbling, guess.centre), 12, guess if held else NOTHING_ELSE)
        for guess in guesses
    ]
    inertias = np.stack([end.arc.log_inertia for end in ends])
    gaps = np.linalg.norm(inertias[:, None] - inertias, axis=-1) + np.eye(5)
    assert (gaps.min() > 0.03) == apart
