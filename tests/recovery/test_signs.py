"""Signs of pieces that are known because the test flipped them."""

from functools import partial
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from debrisest.recovery import signs
from debrisest.recovery.basis_pursuit import Recovered, basis_pursuit
from debrisest.recovery.hypotheses import Hypotheses
from debrisest.recovery.pieces import pieces
from debrisest.recovery.score import lasso_score, sparsity_score
from debrisest.recovery.signs import search_signs

seeds = st.integers(0, 2**32 - 1)
TIME = 240


def smooth_signal(rng):
    """Three sines with periods of 25 to 80 epochs, on no line of any transform, and noise."""
    period = rng.uniform(25, 80, (3, 1))
    phase = rng.uniform(0, 2 * np.pi, (3, 1))
    sines = np.sin(2 * np.pi * np.arange(TIME) / period + phase)
    return np.array([0.6, 0.3, 0.1]) @ sines + 0.005 * rng.standard_normal(TIME)


def mask_with_gaps(rng, count):
    """`count` pieces with 3 to 6 unobserved epochs between them."""
    observed = np.ones(TIME, bool)
    for k in range(1, count):
        begin = k * TIME // count + rng.integers(-3, 4)
        observed[begin : begin + rng.integers(3, 7)] = False
    return observed


def flipped(signal, observed, flips):
    """The signal (run, time) with each piece's sign `flips` (run, piece), NaN in the gaps."""
    return np.where(observed, signal * flips[:, pieces(observed)], np.nan)


@given(seeds)
@settings(max_examples=3, deadline=None)
def test_every_pattern_of_flips_is_undone(seed):
    rng = np.random.default_rng(seed)
    signal, observed = smooth_signal(rng), mask_with_gaps(rng, 7)
    flips = np.array(list(product([1.0, -1.0], repeat=7)))
    runs = flipped(signal, observed, flips)
    sign = search_signs(runs, np.broadcast_to(pieces(observed), runs.shape))
    assert (sign == flips * flips[:, :1]).all()


def test_the_answer_follows_the_score():
    """A score that wants the roughest signal gets it: nothing but the score decides."""
    rng = np.random.default_rng(3)
    signal, observed = smooth_signal(rng), mask_with_gaps(rng, 7)
    flips = rng.choice([-1.0, 1.0], (4, 7))
    runs = flipped(signal, observed, flips)
    piece = np.broadcast_to(pieces(observed), runs.shape)
    right = flips * flips[:, :1]
    assert (search_signs(runs, piece, lasso_score) == right).all()
    wrong = search_signs(runs, piece, lambda solution: -lasso_score(solution))
    assert (wrong != right).any(axis=-1).all()


def test_hypotheses_that_are_passed_over_are_those_that_would_lose(monkeypatch):
    """The same score under another name has all of them recovered, and nothing comes out else."""
    rng = np.random.default_rng(12)
    masks = [mask_with_gaps(rng, 9) for _ in range(12)]
    signals = [smooth_signal(rng) + 0.1 * rng.standard_normal(TIME) for _ in masks]
    flips = rng.choice([-1.0, 1.0], (12, 1, 9))
    runs = np.stack([flipped(*x)[0] for x in zip(signals, masks, flips)])
    piece, recovered = pieces(np.stack(masks)), []

    def counted(samples, *keys, **options):
        recovered.append(samples[..., 0].size)
        return basis_pursuit(samples, *keys, **options)

    monkeypatch.setattr(signs, "basis_pursuit", counted)
    all_of_them = search_signs(runs, piece, lambda solution: lasso_score(solution))
    assert sum(recovered) == 12 * (16 + 4 * 4)
    assert len(recovered) < 2 * 5  # steps, though the masks differ
    recovered.clear()
    np.testing.assert_array_equal(search_signs(runs, piece), all_of_them)
    assert 12 * (16 + 4) <= sum(recovered) < 12 * (16 + 3 * 4)


def test_score_zero_for_all_keeps_the_first_hypotheses():
    rng = np.random.default_rng(4)
    signal, observed = smooth_signal(rng), mask_with_gaps(rng, 7)
    sign = search_signs(
        signal, pieces(observed), lambda solution: np.zeros(solution.objective.shape)
    )
    assert (sign == 1.0).all()


def test_runs_with_other_masks_change_nothing():
    rng = np.random.default_rng(5)
    masks = [mask_with_gaps(rng, count) for count in (1, 3, 7, 7, 9)] + [np.zeros(TIME, bool)]
    masks.append(masks[2])
    runs = np.stack(
        [flipped(smooth_signal(rng), mask, rng.choice([-1.0, 1.0], (1, 9)))[0] for mask in masks]
    )
    piece = pieces(np.stack(masks))
    together = search_signs(runs, piece)
    assert together.shape == (7, 9)
    for k, count in enumerate((1, 3, 7, 7, 9, 0, 7)):
        alone = search_signs(runs[k], piece[k])
        assert alone.shape == (count,)
        assert (alone == together[k, :count]).all()
        assert np.isnan(together[k, count:]).all()
        assert (together[k, : min(count, 1)] == 1.0).all()


def test_batch_axes_are_kept():
    rng = np.random.default_rng(6)
    observed = mask_with_gaps(rng, 6)
    flips = rng.choice([-1.0, 1.0], (6, 6))
    runs = flipped(smooth_signal(rng), observed, flips)
    sign = search_signs(runs.reshape(2, 3, TIME), np.tile(pieces(observed), (2, 3, 1)))
    assert (sign.reshape(6, 6) == flips * flips[:, :1]).all()


def test_nothing_observed_anywhere_has_no_signs():
    assert search_signs(np.full((3, 20), np.nan), np.full((3, 20), -1)).shape == (3, 0)


@pytest.mark.parametrize(("first", "beam"), [(1, 1), (2, 4), (7, 1), (12, 3)])
def test_width_of_the_search_is_free(first, beam):
    rng = np.random.default_rng(7)
    signal, observed = smooth_signal(rng), mask_with_gaps(rng, 7)
    flips = rng.choice([-1.0, 1.0], (1, 7))
    sign = search_signs(
        flipped(signal, observed, flips), pieces(observed)[None], first=first, beam=beam
    )
    assert sign.shape == (1, 7)
    assert first == 1 or (sign == flips * flips[:, :1]).all()


def test_printed_dictionary_runs_with_windows_of_any_length():
    """As many atoms as samples: whatever comes out, it is a sign for every piece."""
    rng = np.random.default_rng(8)
    signal, observed = smooth_signal(rng), mask_with_gaps(rng, 7)
    sign = search_signs(
        np.where(observed, signal, np.nan), pieces(observed), sparsity_score, ratio=1
    )
    assert sign[0] == 1.0
    assert (np.abs(sign) == 1.0).all()


def test_sparsity_score_is_eq_28_on_the_full_spectrum():
    """Lines 0, 1, 2 and 3 of six: modulus 5, twice 0.5, twice 0.02, 1."""
    half = np.array([5.0, 0.3 + 0.4j, 0.02j, -1.0])
    zero = np.zeros(())
    solution = Recovered(np.zeros(6), half, 6, zero, zero.astype(int), zero.astype(int))
    assert sparsity_score(solution) == pytest.approx(6 + 10 * 7.04)
    score = partial(sparsity_score, count_weight=3.0, modulus_weight=2.0, threshold=0.1)
    assert score(solution) == pytest.approx(3 * 4 + 2 * 7.04)


@pytest.mark.parametrize("wrong", [{"first": 0}, {"beam": 0}])
def test_empty_searches_are_refused(wrong):
    with pytest.raises(ValueError, match="at least 1"):
        search_signs(np.ones(20), np.zeros(20, int), **wrong)


def test_what_was_tried_is_kept_in_the_order_of_the_search() -> None:
    """Sixteen signs of five pieces, then two parents with a sixth one of either sign."""
    rng = np.random.default_rng(9)
    observed, short = mask_with_gaps(rng, 7), mask_with_gaps(rng, 3)
    flips = rng.choice([-1.0, 1.0], (2, 7))
    signal = smooth_signal(rng)
    rows = [flipped(signal, observed, flips), flipped(signal, short, flips[:1, :3])]
    runs, piece = np.concatenate(rows), pieces(np.stack([observed, observed, short]))
    tried = Hypotheses(3, 20, 7, TIME)
    found = search_signs(runs, piece, watch=tried)
    assert (found == search_signs(runs, piece))[:2].all()
    told = np.isfinite(tried.sign).sum(axis=-1)
    assert (told[:2] == [5] * 16 + [6] * 4).all()
    assert (told[2] == [3] * 4 + [0] * 16).all()
    for run in range(2):
        order = np.argsort(tried.score[run, :16])[:2]
        parents = tried.sign[run, order, :5]
        np.testing.assert_array_equal(tried.sign[run, 16:, :5], np.tile(parents, (2, 1)))
        np.testing.assert_array_equal(tried.sign[run, 16:, 5], [1, 1, -1, -1])
        best = 16 + int(np.argmin(tried.score[run, 16:]))
        np.testing.assert_array_equal(tried.sign[run, best, :6], found[run, :6])
        end = np.flatnonzero(piece[run] == 5)[-1] + 1
        right = signal[:end] * flips[run, 0]
        assert np.abs(tried.signal[run, best, :end] - right)[observed[:end]].max() < 0.3
        assert np.isnan(tried.signal[run, best, end:]).all()
