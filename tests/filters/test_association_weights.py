"""Probabilities of detections against densities of the hypotheses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2, multivariate_normal

from debrisest.filters.association.weights import (
    Validation,
    absence_weight,
    inverse_unit_ball,
    nearest,
    probabilistic,
)

BALL = {1: 2.0, 2: np.pi, 3: 4.0 * np.pi / 3.0}
probability = st.floats(0.05, 1.0)


def spread(d, seed):
    root = np.random.default_rng(seed).normal(size=(d, d))
    return root @ root.T + 0.1 * np.eye(d)


def missed(count, total, gate, detected, passed, d):
    """b = lambda |2 pi S|^(1/2) (1 - P_D P_G) / P_D with as many clutter points as validated."""
    density = count / (BALL[d] * np.sqrt(np.linalg.det(gate * total)))
    return (
        density * np.sqrt(np.linalg.det(2.0 * np.pi * total)) * (1.0 - detected * passed) / detected
    )


@given(
    st.integers(1, 9), st.floats(0.5, 20.0), probability, st.sampled_from([1, 2, 3]), st.integers(0)
)
def test_absence_weighs_as_its_density(count, gate, detected, d, seed):
    expected = missed(count, spread(d, seed), gate, detected, chi2.cdf(gate, d), d)
    b = absence_weight(count, Validation(gate, detected), d)
    assert b == pytest.approx(expected, rel=1e-9, abs=1e-15)


def test_the_printed_weight_is_too_large_by_the_square_of_the_unit_circle() -> None:
    rule = Validation(gate=5.0, detection_probability=0.7, gate_probability=0.9)
    b = absence_weight(3, rule, 2)
    assert b == pytest.approx(missed(3, np.eye(2), 5.0, 0.7, 0.9, 2), rel=1e-12)
    assert b == pytest.approx(0.634, abs=5e-4)
    assert absence_weight(3, rule._replace(ball=inverse_unit_ball), 2) == pytest.approx(
        np.pi**2 * b
    )


@pytest.mark.parametrize(("ball", "factor"), [(None, 0.8), (inverse_unit_ball, 1.97)])
def test_four_dimensions_change_the_weight_of_absence(ball, factor) -> None:
    """b(4) / b(2) = (2 pi / gamma) C_2 / C_4 with C_2 = pi, C_4 = pi^2 / 2; inverse as printed."""
    rule = Validation(gate=5.0, detection_probability=0.7, gate_probability=0.9)
    rule = rule if ball is None else rule._replace(ball=ball)
    b = absence_weight(3, rule._replace(dimension=4), 2) / absence_weight(3, rule, 2)
    volumes = 2 / np.pi if ball is None else np.pi / 2
    assert b == pytest.approx(2 * np.pi / 5 * volumes, rel=1e-12)
    assert b == pytest.approx(factor, abs=5e-3)


def test_the_probability_of_the_gate_is_that_of_chi_square() -> None:
    assert Validation(gate=chi2.ppf(0.9, 2)).passing(2) == pytest.approx(0.9, abs=1e-12)
    assert Validation(gate=5.0).passing(4) == pytest.approx(0.7127, abs=5e-5)


@given(st.integers(1, 6), probability, st.integers(0))
def test_probabilities_are_those_of_the_hypotheses(count, detected, seed):
    rng, gate = np.random.default_rng(seed), 9.0
    total = spread(2, rng.integers(1 << 30))
    nu = 2.0 * rng.normal(size=(count, 2))
    squared = np.array([v @ np.linalg.inv(total) @ v for v in nu])
    valid = squared <= gate
    density = multivariate_normal(np.zeros(2), total).pdf(nu).reshape(count) * valid
    none = missed(valid.sum(), total, gate, detected, chi2.cdf(gate, 2), 2)
    none *= 1.0 / np.sqrt(np.linalg.det(2.0 * np.pi * total))
    expected = density / (density.sum() + none) if valid.any() else np.zeros(count)
    beta = probabilistic(np.where(valid, squared, np.inf), Validation(gate, detected), 2)
    assert beta == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("rule", [Validation(), Validation(5.0, 1.0), Validation(np.inf, 1.0)])
@pytest.mark.parametrize("columns", [0, 1, 4])
def test_nothing_validated_is_nothing_believed(rule, columns):
    distance = np.full((3, columns), np.inf)
    assert np.array_equal(probabilistic(distance, rule, 2), np.zeros((3, columns)))
    assert np.array_equal(nearest(distance), np.zeros((3, columns)))


def test_a_target_that_cannot_be_missed_is_among_the_validated() -> None:
    distance = np.array([[4000.0, 4004.0, np.inf], [1.0, np.inf, np.inf]])
    beta = probabilistic(distance, Validation(np.inf, 1.0), 2)
    one = 1.0 / (1.0 + np.exp(-2.0))
    assert beta == pytest.approx(np.array([[one, 1.0 - one, 0.0], [1.0, 0.0, 0.0]]))


def test_the_nearest_takes_all() -> None:
    distance = np.array([[3.0, 1.0, np.inf], [np.inf, np.inf, 7.0]])
    assert np.array_equal(nearest(distance), [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize(
    "rule",
    [
        Validation(gate=0.0),
        Validation(gate=-1.0),
        Validation(detection_probability=0.0),
        Validation(detection_probability=1.1),
        Validation(gate_probability=2.0),
    ],
)
def test_settings_without_sense_are_refused(rule):
    with pytest.raises(ValueError, match="probability"):
        rule.checked()
