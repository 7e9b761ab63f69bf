"""Local rates and the inertia from the conservation of angular momentum."""

import numpy as np
from scipy.spatial.transform import Rotation

from debrisest.batch.attitudes import Attitudes
from debrisest.batch.local_rates import local_rates
from debrisest.batch.momentum_start import inertia_start
from debrisest.dynamics import log_inertia


def local_of(truth, sigma, seed=0):
    rng = np.random.default_rng(seed)
    turns = Rotation.from_rotvec(sigma * rng.normal(size=(len(truth.times), 3)))
    q = (turns * truth.attitude).as_quat(scalar_first=True)
    information = np.tile(np.eye(3) / sigma**2, (len(q), 1, 1))
    return local_rates(truth.times, Attitudes(truth.times, q, information).seen())


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
    true = log_inertia.log_ratios(tumbling.inertia)
    assert np.linalg.norm(found - true) < np.linalg.norm(true) / 3.0


def test_start_is_that_of_a_body(tumbling) -> None:
    moments = np.linalg.eigvalsh(log_inertia.inertia(inertia_start(local_of(tumbling, 0.3))))
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
