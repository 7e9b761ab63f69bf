"""Pieces against a loop over the epochs; continuity as properties."""

from itertools import groupby

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from debrisest.recovery.pieces import continuous, pieces

masks = arrays(np.bool_, st.tuples(st.integers(1, 3), st.integers(1, 30)))
seeds = st.integers(0, 2**32 - 1)


def counted(mask):
    """Piece of each epoch, one run of equal values after the other."""
    index, number = [], 0
    for seen, run in groupby(mask):
        index += [number if seen else -1 for _ in run]
        number += bool(seen)
    return index


def smooth_quaternions(rng, shape):
    """Unit quaternions (*shape, 4) that turn by less than 90 degrees from one to the next."""
    q = np.empty((*shape, 4))
    q[..., 0, :] = rng.standard_normal((*shape[:-1], 4))
    for k in range(1, shape[-1]):
        step = rng.standard_normal((*shape[:-1], 4))
        q[..., k, :] = q[..., k - 1, :] + 0.3 * step / np.linalg.norm(step, axis=-1, keepdims=True)
        q[..., k, :] /= np.linalg.norm(q[..., k, :], axis=-1, keepdims=True)
    q[..., 0, :] /= np.linalg.norm(q[..., 0, :], axis=-1, keepdims=True)
    return q


@given(masks)
def test_pieces_are_runs_of_observed_epochs(observed):
    assert pieces(observed).tolist() == [counted(mask) for mask in observed]


def test_a_signal_without_epochs_or_without_samples_has_no_piece():
    assert pieces(np.zeros((2, 0), bool)).shape == (2, 0)
    assert (pieces(np.zeros((2, 5), bool)) == -1).all()


@given(masks, seeds)
def test_random_flips_are_undone_inside_each_piece(observed, seed):
    rng = np.random.default_rng(seed)
    piece = pieces(observed)
    smooth = np.where(observed[..., None], smooth_quaternions(rng, observed.shape), np.nan)
    turns = np.sum(smooth[:, 1:] * smooth[:, :-1], axis=-1)
    assume(not (turns <= 0).any())
    flips = rng.choice([-1.0, 1.0], observed.shape)[..., None]
    result = continuous(smooth * flips, piece)
    sign = np.sum(result * smooth, axis=-1)
    assert (np.isnan(result).all(axis=-1) == ~observed).all()
    for row in range(len(piece)):
        for number in range(piece[row].max() + 1):
            inside = np.flatnonzero(piece[row] == number)
            first = flips[row, inside[0], 0]
            np.testing.assert_allclose(sign[row, inside], first, atol=1e-12)


@given(masks, seeds)
def test_only_whole_quaternions_change_sign(observed, seed):
    q = np.random.default_rng(seed).standard_normal((*observed.shape, 4))
    ratio = continuous(q, pieces(observed)) / q
    assert (np.abs(ratio) == 1).all()
    assert (ratio == ratio[..., :1]).all()


def test_each_signal_has_its_own_pieces():
    rng = np.random.default_rng(1)
    q = rng.standard_normal((3, 4, 20, 4))
    piece = pieces(rng.random((3, 4, 20)) < 0.7)
    for index in np.ndindex(3, 4):
        assert (continuous(q, piece)[index] == continuous(q[index], piece[index])).all()
