"""Search for the signs of a signal's pieces (Biondi et al. 2017, Sec. 4).

q and -q are the same attitude, and nothing but the smoothness of the whole signal tells which of
the two continues it across a gap. All signs of the first pieces are tried, the best hypotheses
are kept, then the pieces are added one at a time, each with both signs. Where the recovery without
a piece is clear about its sign, the other one is not tried (the paper tries all).
"""

from collections.abc import Callable, Generator
from functools import partial
from itertools import product
from math import ceil
from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array, BoolArray, ComplexArray, IntArray
from debrisest.recovery.basis_pursuit import Recovered, basis_pursuit
from debrisest.recovery.fourier import analyse, synthesise
from debrisest.recovery.in_step import Question, Search, in_step
from debrisest.recovery.score import Score, lasso_score

Watch = Callable[[IntArray, Array, Array, Array], None]
"""Is told the runs, and the signs, signals, penalties (run, hypothesis, ...) tried for them."""

_DOUBLINGS = 3
_DOUBT = 10.0
"""Penalties by which a hypothesis is predicted to be worse than the best, and is dropped."""


class _Search(NamedTuple):
    """What stays the same during the search: runs (run, time) with the same `piece` (time)."""

    runs: IntArray
    samples: Array
    piece: IntArray
    score: Score
    watch: Watch | None
    ratio: float
    penalty: float
    beam: int


class _Beam(NamedTuple):
    """The hypotheses in force, the best one first."""

    sign: Array
    """Signs (run, hypothesis, piece) of the pieces so far."""
    coefficients: ComplexArray
    """Their recovery, half spectra (run, hypothesis, length // 2 + 1)."""
    score: Array
    """Their penalties (run, hypothesis), infinite where there is no hypothesis."""
    length: int


_Step = Generator[Question, Recovered, _Beam]


def search_signs(
    samples: Array,
    piece: IntArray,
    score: Score = lasso_score,
    *,
    ratio: float = 2.0,
    penalty: float = 0.3,
    splitting: float = 0.1,
    relaxation: float = 1.6,
    first: int = 5,
    beam: int = 2,
    first_iterations: int = 60,
    iterations: int = 8,
    watch: Watch | None = None,
) -> Array:
    """Sign (..., piece) of every piece of `samples` (..., time), +1 for the first.

    `samples` is one component of the quaternions, continuous inside each `piece` (..., time). The
    first `first` pieces are tried with all signs, the best `beam` hypotheses are kept; the window
    ends with the newest piece. Later hypotheses start from their parent's recovery, hence fewer
    `iterations`. A signal with fewer pieces than the others has NaN for those it lacks.

    `ratio` is that of atoms to samples (1 as printed, and then the search fails; see
    `dictionary_length`); during the search it is between `ratio` and twice that, so that the
    length seldom changes. The remaining parameters are those of `basis_pursuit`. ``watch`` is told
    every step of the search.
    """
    if first < 1 or beam < 1:
        raise ValueError("the pieces tried first and the width of the beam must be at least 1")
    runs = samples.reshape(-1, samples.shape[-1])
    masks, group = np.unique(piece.reshape(runs.shape), axis=0, return_inverse=True)
    sign = np.full((len(runs), int(piece.max(initial=-1)) + 1), np.nan)
    same = [np.flatnonzero(group.reshape(-1) == index) for index in range(len(masks))]
    searches = [
        _Search(of, runs[of], mask, score, watch, ratio, penalty, beam)
        for of, mask in zip(same, masks)
        if mask.max(initial=-1) >= 0
    ]
    recover = partial(_recover, penalty=penalty, splitting=splitting, relaxation=relaxation)
    steps = [_search(search, first, first_iterations, iterations) for search in searches]
    for search, found in zip(searches, in_step(steps, recover)):
        sign[search.runs, : found.shape[-1]] = found
    return sign.reshape(*samples.shape[:-1], sign.shape[-1])


def _recover(question: Question, penalty: float, splitting: float, relaxation: float) -> Recovered:
    """What is asked, in single precision: it is only compared."""
    return basis_pursuit(
        question.samples,
        question.observed,
        question.length,
        penalty,
        splitting,
        question.iterations,
        relaxation=relaxation,
        tolerance=0.0,
        single=True,
        start=question.start,
    )


def _search(search: _Search, first: int, first_iterations: int, iterations: int) -> Search:
    """Signs (run, piece) of the best hypothesis at the end."""
    count = int(search.piece.max()) + 1
    beam = yield from _exhaust(search, min(first, count), first_iterations)
    for _ in range(min(first, count), count):
        beam = yield from _extend(search, beam, iterations)
    return beam.sign[:, 0]


def _exhaust(search: _Search, count: int, iterations: int) -> _Step:
    """The best hypotheses on the first `count` pieces, out of all: 2^(count - 1)."""
    signs = np.array([(1.0, *rest) for rest in product((1.0, -1.0), repeat=count - 1)])
    return (yield from _best(search, np.tile(signs, (len(search.samples), 1, 1)), iterations, None))


def _extend(search: _Search, beam: _Beam, iterations: int) -> _Step:
    """The best hypotheses after one more piece, added to each with both signs."""
    plus = np.ones_like(beam.sign[..., :1])
    children = [np.concatenate([beam.sign, newest], axis=-1) for newest in (plus, -plus)]
    return (yield from _best(search, np.concatenate(children, axis=1), iterations, beam))


def _best(search: _Search, sign: Array, iterations: int, parents: _Beam | None) -> _Step:
    """The hypotheses `sign` (run, hypothesis, piece) with the lowest scores."""
    window = int(np.flatnonzero(search.piece == sign.shape[-1] - 1)[-1]) + 1
    piece = search.piece[:window]
    length = _length(search, window)
    samples = search.samples[:, None, :window] * sign[..., piece]
    tried, start = np.ones(sign.shape[:2], bool), None
    if parents is not None:
        known = _grown(parents, length, window)
        tried = _plausible(search, samples, piece, known)
        run, hypothesis = np.nonzero(tried)
        start = known.coefficients[run, hypothesis % known.score.shape[1]]
    recovered = yield Question(samples[tried], piece >= 0, length, iterations, start)
    score = np.full(tried.shape, np.inf)
    score[tried] = search.score(recovered)
    if search.watch is not None:
        search.watch(search.runs, sign, recovered.signal.reshape(*tried.shape, -1), score)
    best = np.argsort(score, axis=-1, kind="stable")[:, : search.beam]
    row = np.take_along_axis(np.cumsum(tried).reshape(tried.shape) - 1, best, axis=1)
    return _Beam(
        np.take_along_axis(sign, best[..., None], axis=1),
        recovered.coefficients[row],
        np.take_along_axis(score, best, axis=1),
        length,
    )


def _plausible(search: _Search, samples: Array, piece: IntArray, parents: _Beam) -> BoolArray:
    """Tell the hypotheses (run, hypothesis) that are recovered: first all with +, then with -.

    The lasso of a hypothesis is predicted to be that of its parent and, at the newest piece, half
    the squared misfit of the parent's recovery, from which it starts.
    """
    if search.score is not lasso_score or search.watch is not None:
        return np.ones(samples.shape[:2], bool)
    newest = piece == piece.max()
    shown = synthesise(parents.coefficients, parents.length, len(piece))[..., newest]
    misfit = samples[..., newest] - np.concatenate([shown, shown], axis=1)
    predicted = np.tile(parents.score, 2) + 0.5 * np.sum(misfit**2, axis=-1)
    least = predicted.min(axis=-1, keepdims=True)
    return np.asarray(predicted <= least + _DOUBT * search.penalty)


def _length(search: _Search, window: int) -> int:
    """Number of atoms for a window: the window itself, or a coarse grid of doubled lengths."""
    if search.ratio == 1:
        return window
    length = scipy.fft.next_fast_len(
        ceil(search.ratio * len(search.piece) / 2**_DOUBLINGS), real=True
    )
    while length < search.ratio * window:
        length *= 2
    return length


def _grown(parents: _Beam, length: int, window: int) -> _Beam:
    """The parents in a dictionary and a window that have grown."""
    if length == parents.length:
        return parents
    known = synthesise(parents.coefficients, parents.length, min(parents.length, window))
    return parents._replace(coefficients=analyse(known, length) / length, length=length)
