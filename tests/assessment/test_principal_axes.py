"""The relabelings of principal axes: a group, and the best of them."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.assessment.principal_axes import RELABELINGS, best_relabeling

indices = st.integers(0, 23)
seeds = st.integers(0, 2**32)


def index_of(matrix: np.ndarray) -> int:
    found = np.flatnonzero((matrix == RELABELINGS).all(axis=(1, 2)))
    assert len(found) == 1
    return int(found[0])


def test_there_are_24_rotations_that_permute_the_axes() -> None:
    assert RELABELINGS.shape == (24, 3, 3)
    assert len({matrix.tobytes() for matrix in RELABELINGS + 0.0}) == 24
    assert np.array_equal(np.linalg.det(RELABELINGS).round(9), np.ones(24))
    assert (np.abs(RELABELINGS).sum(axis=-1) == 1).all()
    assert (np.abs(RELABELINGS).sum(axis=-2) == 1).all()


def test_they_form_a_group() -> None:
    index_of(np.eye(3))
    for first, second in itertools.product(RELABELINGS, repeat=2):
        index_of(first @ second)
    for matrix in RELABELINGS:
        index_of(matrix.T)


def test_a_cube_has_the_same_rotations() -> None:
    """Products of quarter turns about two axes, an independent construction."""
    x = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    z = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    reached = {np.eye(3, dtype=int).tobytes(): np.eye(3, dtype=int)}
    while True:
        more = {(m @ t).tobytes(): m @ t for m in reached.values() for t in (x, z)}
        if more.keys() <= reached.keys():
            break
        reached |= more
    assert {m.astype(int).tobytes() for m in RELABELINGS} == set(reached)


def rates(seed: int, runs: int = 2) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((runs, 30, 3)) * [0.1, 0.3, 0.2]


@given(seeds, indices)
def test_a_relabeled_truth_is_found_again(seed: int, index: int) -> None:
    true = rates(seed)
    found = best_relabeling(true @ RELABELINGS[index], true)
    assert np.array_equal(found, np.stack([RELABELINGS[index]] * 2))


@given(seeds, indices)
def test_relabeling_the_estimate_changes_nothing_that_is_scored(seed: int, index: int) -> None:
    true, noise = rates(seed), rates(seed + 1)
    estimated, other = true + noise, (true + noise) @ RELABELINGS[index].T
    aligned = estimated @ np.swapaxes(best_relabeling(estimated, true), -1, -2)
    again = other @ np.swapaxes(best_relabeling(other, true), -1, -2)
    assert again == pytest.approx(aligned, abs=1e-12)


@given(seeds, indices)
def test_relabeling_both_relabels_the_error(seed: int, index: int) -> None:
    true, noise, turn = rates(seed), rates(seed + 1), RELABELINGS[index]
    best = best_relabeling(true + noise, true)
    assert np.array_equal(
        best_relabeling((true + noise) @ turn.T, true @ turn.T), turn @ best @ turn.T
    )


@given(seeds)
def test_no_relabeling_has_less_error(seed: int) -> None:
    true, estimated = rates(seed), rates(seed + 1)
    for run, best in enumerate(best_relabeling(estimated, true)):
        errors = [np.sum((estimated[run] @ m.T - true[run]) ** 2) for m in RELABELINGS]
        assert np.sum((estimated[run] @ best.T - true[run]) ** 2) <= min(errors) * (1 + 1e-12)


def test_each_run_has_its_own() -> None:
    true = rates(0, 24)
    estimated = np.stack([true[i] @ m for i, m in enumerate(RELABELINGS)])
    assert np.array_equal(best_relabeling(estimated, true), RELABELINGS)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_run_that_is_not_finite_keeps_its_labels(value: float) -> None:
    true, turn = rates(0), RELABELINGS[7]
    estimated = true @ turn
    estimated[0, 5, 1] = value
    with np.errstate(invalid="ignore"):
        found = best_relabeling(estimated, true)
    assert np.array_equal(found, [np.eye(3), turn])
