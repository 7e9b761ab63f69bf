"""One epoch against the Gaussian mixture over all hypotheses."""

from itertools import product

import numpy as np
import pytest
from scipy.stats import chi2

from debrisest.filters.association.single import associated
from debrisest.filters.association.weights import Validation
from debrisest.filters.scan_model import ScanModel

GATE, DETECTED = 6.0, 0.75
R = np.array([[0.6, 0.2], [0.2, 0.9]])
NAMES = ("a", "b", "c")


def case(seed, sensors, detections=4):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(3, 3))
    h = rng.normal(size=(sensors, 2, 3))
    covariance = root @ root.T + 0.2 * np.eye(3)
    state = rng.normal(size=3)
    near = h @ rng.multivariate_normal(state, covariance)
    scan = near[:, None] + 1.5 * rng.normal(size=(sensors, detections, 2))
    return h, state, covariance, scan


def model_of(h):
    return ScanModel(
        process=lambda x, _: x,
        process_jacobian=lambda _x, _k: np.eye(3),
        process_noise=np.zeros((3, 3)),
        points=lambda x, _: (h @ x[..., None, :, None])[..., 0],
        points_jacobian=lambda _x, _k: h,
        noise=R,
        error_names=NAMES,
    )


def filtered(h, state, covariance, scan, **options):
    history = associated(
        *(model_of(h), state[None], covariance[None], scan[None, None]),
        Validation(GATE, DETECTED),
        **options,
    )
    return history.state[0, 0], history.covariance[0, 0]


def hypotheses(h, state, covariance, scan):
    """Validated innovations and probabilities at one sensor; None is that none is the target's."""
    total = h @ covariance @ h.T + R
    nu = [z - h @ state for z in scan]
    nu = [v for v in nu if v @ np.linalg.inv(total) @ v <= GATE]
    density = len(nu) / (np.pi * GATE * np.sqrt(np.linalg.det(total)))
    found = [(None, density * (1 - DETECTED * chi2.cdf(GATE, 2)) if nu else 1.0)]
    scale = DETECTED / (2 * np.pi * np.sqrt(np.linalg.det(total)))
    found += [(v, scale * np.exp(-0.5 * v @ np.linalg.inv(total) @ v)) for v in nu]
    weight = sum(w for _, w in found)
    return [(v, w / weight) for v, w in found]


def moments(parts):
    """Mean and covariance of a mixture of (weight, mean, covariance)."""
    mean = sum(w * m for w, m, _ in parts)
    return mean, sum(w * (p + np.outer(m - mean, m - mean)) for w, m, p in parts)


def one_sensor(h, state, covariance, scan):
    """Every hypothesis updated in information form, then their moments."""
    parts = []
    for nu, weight in hypotheses(h, state, covariance, scan):
        if nu is None:
            parts.append((weight, state, covariance))
            continue
        information = np.linalg.inv(covariance) + h.T @ np.linalg.inv(R) @ h
        posterior = np.linalg.inv(information)
        step = posterior @ h.T @ np.linalg.inv(R) @ nu
        parts.append((weight, state + step, posterior))
    return moments(parts)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("sensors", [1, 2, 3])
def test_sensor_after_sensor_keeps_the_moments_of_the_mixture(seed, sensors):
    h, state, covariance, scan = case(seed, sensors)
    found = filtered(h, state, covariance, scan)
    for s in range(sensors):
        state, covariance = one_sensor(h[s], state, covariance, scan[s])
    np.testing.assert_allclose(found[0], state, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(found[1], covariance, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("seed", range(12))
def test_one_gain_for_all_keeps_the_moments_of_its_mixture(seed):
    """Each combination of hypotheses with the columns of the common gain that it uses."""
    h, state, covariance, scan = case(seed, 2)
    each = [hypotheses(h[s], state, covariance, scan[s]) for s in range(2)]
    used = [s for s in range(2) if len(each[s]) > 1]
    stack = np.concatenate([h[s] for s in used]) if used else np.zeros((0, 3))
    noise = np.kron(np.eye(len(used)), R)
    gain = covariance @ stack.T @ np.linalg.inv(stack @ covariance @ stack.T + noise)
    parts = []
    for chosen in product(*each):
        weight, mean, kept, added = 1.0, state, np.eye(3), np.zeros((3, 3))
        for s, (nu, w) in enumerate(chosen):
            weight *= w
            if nu is not None:
                place = used.index(s)
                columns = gain[:, 2 * place : 2 * place + 2]
                mean, kept = mean + columns @ nu, kept - columns @ h[s]
                added = added + columns @ R @ columns.T
        parts.append((weight, mean, kept @ covariance @ kept.T + added))
    expected = moments(parts)
    found = filtered(h, state, covariance, scan, stacked=True)
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("stacked", [False, True])
def test_a_sensor_that_predicts_nothing_is_not_used(stacked):
    h, state, covariance, scan = case(3, 2)
    blind = h.copy()
    blind[0] = np.nan
    found = filtered(blind, state, covariance, scan, stacked=stacked)
    expected = filtered(h[1:], state, covariance, scan[1:], stacked=stacked)
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-12)
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-12)
