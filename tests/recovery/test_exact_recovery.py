"""The exact recovery coefficient against its definition, with atoms written out."""

import numpy as np
import pytest

from debrisest.recovery.exact_recovery import exact_recovery_coefficient


def _defined(used: list[int], seen: np.ndarray, length: int) -> float:
    """With unit atoms and a pseudo-inverse, as Tropp has it."""
    atoms = np.exp(2j * np.pi * np.outer(np.flatnonzero(seen), np.arange(length)) / length)
    atoms /= np.linalg.norm(atoms, axis=0)
    inverse = np.linalg.pinv(atoms[:, used])
    others = [k for k in range(length) if k not in used]
    return 1.0 - max(np.abs(inverse @ atoms[:, k]).sum() for k in others)


@pytest.mark.parametrize("length", [40, 80])
def test_it_is_that_of_the_definition(length: int) -> None:
    seen = np.random.default_rng(2).random(40) < 0.8
    half = np.zeros(length // 2 + 1, complex)
    half[[0, 3, 11]] = 1.0, 2.0 - 1j, 0.1j
    used = [0, 3, 11, length - 11, length - 3]
    found = exact_recovery_coefficient(half, seen, length)
    assert found == pytest.approx(_defined(used, seen, length), abs=1e-9)


def test_a_whole_period_without_gaps_is_recovered_exactly_whatever_its_lines() -> None:
    half = np.zeros((2, 21), complex)
    half[0, [1, 2, 3]], half[1, 7] = 1.0, 1j
    found = exact_recovery_coefficient(half, np.ones((2, 40), bool), 40)
    np.testing.assert_allclose(found, 1.0, atol=1e-12)


def test_without_lines_or_samples_there_is_none() -> None:
    half, seen = np.zeros((2, 21), complex), np.array([[True] * 40, [False] * 40])
    half[1, 1] = 1.0
    assert np.isnan(exact_recovery_coefficient(half, seen, 40)).all()
