"""Whether the signs of the pieces were right."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.assessment.signs import signs_right

EPOCHS, LENGTH = 60, 10


def tumbling(runs: int = 1) -> np.ndarray:
    """Continuous quaternions (run, time, 4) that go round more than twice."""
    half = np.linspace(0.0, 8.0, EPOCHS)
    q = np.stack([np.cos(half), 0.6 * np.sin(half), 0 * half, 0.8 * np.sin(half)], axis=-1)
    return np.broadcast_to(q, (runs, EPOCHS, 4)).copy()


def in_pieces(runs: int = 1, gap: int = 3) -> np.ndarray:
    piece = np.repeat(np.arange(6.0), LENGTH)
    piece[np.arange(EPOCHS) % LENGTH < gap] = np.nan
    return np.broadcast_to(piece, (runs, EPOCHS)).copy()


def measured(true: np.ndarray, piece: np.ndarray, flips: np.ndarray) -> np.ndarray:
    """The truth with the sign of each piece, NaN between pieces."""
    each = flips[..., np.nan_to_num(piece[0]).astype(int)]
    return np.where(np.isnan(piece)[..., None], np.nan, true * each[..., None])


signs = st.lists(st.sampled_from([-1.0, 1.0]), min_size=6, max_size=6).map(np.array)


@given(signs, signs, st.sampled_from([-1.0, 1.0]))
def test_the_share_of_right_changes(flips: np.ndarray, given_: np.ndarray, free: float) -> None:
    true, piece = tumbling(), in_pieces()
    raw = measured(true, piece, flips[None])
    right = flips[1:] * flips[:-1] == given_[1:] * given_[:-1]
    assert signs_right(raw, piece, free * given_[None], true)[0] == pytest.approx(right.mean())


@given(signs, st.integers(0, 2**32))
def test_the_sign_of_the_truth_is_free(flips: np.ndarray, seed: int) -> None:
    true, piece = tumbling(), in_pieces()
    raw = measured(true, piece, flips[None])
    jumps = np.random.default_rng(seed).choice([-1.0, 1.0], EPOCHS)[None, :, None]
    assert signs_right(raw, piece, flips[None], true * jumps)[0] == 1.0


def test_noise_does_not_change_what_is_right() -> None:
    true, piece = tumbling(), in_pieces()
    flips = np.array([[1.0, -1.0, -1.0, 1.0, -1.0, 1.0]])
    raw = measured(true, piece, flips)
    raw = raw + 0.1 * np.random.default_rng(0).standard_normal(raw.shape)
    assert signs_right(raw, piece, flips, true)[0] == 1.0
    assert signs_right(raw, piece, np.ones((1, 6)), true)[0] == pytest.approx(1 / 5)


def test_runs_with_fewer_pieces() -> None:
    true, piece = tumbling(3), in_pieces(3)
    piece[1, 30:] = np.nan
    piece[2, 10:] = np.nan
    sign = np.ones((3, 6))
    sign[1, 3:] = sign[2, 1:] = np.nan
    raw = measured(true, in_pieces(), np.ones((3, 6)))
    raw[np.isnan(piece)] = np.nan
    assert signs_right(raw, piece, sign, true).tolist() == [1.0, 1.0, 1.0]
    sign[1, 2] = -1
    assert signs_right(raw, piece, sign, true).tolist() == [1.0, 0.5, 1.0]


def test_without_any_piece_no_decision_was_wrong() -> None:
    true = tumbling()
    nothing = np.full((1, EPOCHS), np.nan)
    share = signs_right(np.full_like(true, np.nan), nothing, np.full((1, 1), np.nan), true)
    assert share.tolist() == [1.0]
