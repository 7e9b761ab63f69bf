"""The floor of the cost along one error: the least cost with that error held, to both sides of it.

It is sought three sigma away, from the line on that the covariance says, and followed on where it
is lower than nine. A look along the line does not tell: of a product it is a parabola, though its
floor is not. The held error is put back after every step, whose charts bend, and what the floor is
off the line ahead is what it is begun with behind.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.replay.gauss_newton import Held, gauss_newton, move
from debrisest.filters.replay.measured_arc import Linearization, MeasuredArc
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.runs import take

_FAR, _SURE = 3.0, 5.0
"""Sigmas at which a valley is looked for, and to which one that is open is followed."""
_OPEN = 0.6
"""Part of the prior's sigma from which on an error is as good as untold: no valley is to be
followed."""
_LOW, _STEEP = 0.7, 1.7
"""Of the rise of a parabola: where the floor is to be followed on, and where it tells nothing."""
_LIKE = 0.3
"""Part of nine by which the floor ahead may be off for its way to be that of the floor behind."""
_GROWTH, _LEVELS = 3.0, 8
_FIRM = 1e-3  # sigma with which an error is held, in its own sigmas
_ITERATIONS, _TOLERANCE = 24, 1.0
"""With six iterations some floors were taken for steep that were not found yet."""
_FARTHER = 1.2
"""Times as far as before, at which a floor that goes on is found at least: else it ends there."""


class _Sides(NamedTuple):
    """Both sides of every error that is told, one after the other."""

    run: IntArray
    error: IntArray
    sign: Array
    sigma: Array
    """By the curvature at the estimate."""
    farthest: Array
    """Three sigma of the prior."""


def errors_per_sigma(
    model: ReplayModel, arc: MeasuredArc, at: Linearization, epochs: Sequence[int]
) -> Array:
    """Errors ``(epoch, 2, run, error, n_e)`` per sigma, ahead and behind, on the floor.

    Of all errors; NaN: of one that does not bend, or is not told, or whose floor tells nothing.
    """
    spread = scaled_inverse(at.information)
    sides = _sides(model, arc, spread)
    result = np.full((len(epochs), 2, *spread.shape), np.nan)
    if len(sides.run) == 0:
        return result
    toward = sides.sign[:, None] * spread[sides.run, :, sides.error] / sides.sigma[:, None]
    ends, far = _followed(model, arc, at, sides, toward)
    part = model.of(sides.run)
    estimate, end = model.shown(at.state, max(epochs))[0], part.shown(ends, max(epochs))[0]
    for slot, k in enumerate(epochs):
        at_k = estimate[sides.run, k]
        error = part.inverse_chart(at_k) @ part.difference(end[:, k], at_k)[..., None]
        way = sides.sign[:, None] * error[..., 0] / far[:, None]
        for i in range(2):
            result[slot, i, sides.run[i::2], sides.error[i::2]] = way[i::2]
    return result


def _sides(model: ReplayModel, arc: MeasuredArc, spread: Array) -> _Sides:
    sigma, of_prior = (
        np.sqrt(np.diagonal(matrix, 0, -2, -1)[:, list(model.bending)])
        for matrix in (spread, scaled_inverse(arc.information))
    )
    run, column = np.nonzero(sigma < _OPEN * of_prior)
    run, column = np.repeat(run, 2), np.repeat(column, 2)
    sign = np.tile([1.0, -1.0], len(run) // 2)
    error = np.array(model.bending)[column]
    return _Sides(run, error, sign, sigma[run, column], _FAR * of_prior[run, column])


def _followed(
    model: ReplayModel, arc: MeasuredArc, at: Linearization, sides: _Sides, toward: Array
) -> tuple[Array, Array]:
    """Ends of the floor (side, n), and how many sigmas (side,) they are away; NaN: tells nothing.

    It is followed to five sigma, to where no body is beyond, or the prior forbids it; of all places
    that are passed the one counts that asks for the largest sigma.
    """
    found, rise, behind = _first_floor(model, arc, at, sides, toward)
    sigmas = np.sqrt(np.maximum(rise, 1.0))
    tells = (rise < _STEEP * _FAR**2) & (behind > 0.0)
    ends, far = found.copy(), np.where(tells, sigmas, np.nan)
    largest = np.where(tells, behind / sigmas, 0.0)
    on = tells & (rise < _LOW * _FAR**2) & (_FARTHER * behind < sides.farthest)
    going = np.flatnonzero(on)
    for _ in range(_LEVELS - 1):
        if len(going) == 0:
            break
        side = take(sides, going)
        distance = np.minimum(_GROWTH * behind[going], side.farthest)
        start = _pushed(model.of(side.run), found[going], side, distance - behind[going])
        new, rise, reached = _floor(model, arc, at, side, start, distance)
        sigmas = np.sqrt(np.maximum(rise, 1.0))
        better = reached / sigmas > largest[going]
        ends[going[better]], far[going[better]] = new[better], sigmas[better]
        largest[going[better]] = (reached / sigmas)[better]
        on = (rise < _SURE**2) & (reached > _FARTHER * behind[going])
        on &= _FARTHER * reached < side.farthest
        found[going], behind[going] = new, reached
        going = going[on]
    return ends, far


def _first_floor(
    model: ReplayModel, arc: MeasuredArc, at: Linearization, sides: _Sides, toward: Array
) -> tuple[Array, Array, Array]:
    """The floor at three sigma, as of `_floor`, of all sides: behind begun as it was ahead."""
    distance = _FAR * sides.sigma
    line = move(model.of(sides.run), at.state[sides.run], _FAR * toward)
    line = _held(at, sides, distance).kept(model.of(sides.run), line)
    ahead, behind = (take(sides, np.arange(first, len(line), 2)) for first in range(2))
    part = model.of(ahead.run)
    found = _floor(model, arc, at, ahead, line[::2], distance[::2])
    like = np.abs(found[1] / _FAR**2 - 1.0) < _LIKE
    mirrored = part.retract(line[1::2], part.difference(found[0], line[::2]))
    start = np.where(like[:, None], mirrored, line[1::2])
    other = _floor(model, arc, at, behind, start, distance[1::2])
    ends, rises, reached = (np.stack(pair, 1) for pair in zip(found, other))
    return ends.reshape(line.shape), rises.ravel(), reached.ravel()


def _pushed(model: ReplayModel, state: Array, side: _Sides, by: Array) -> Array:
    """States (side, n) whose error is pushed on by itself: the others follow, best from there.

    Of a product of both, what is linearised with the one before it moves is wrong for the other.
    """
    step = np.zeros((len(state), len(model.error_names)))
    step[np.arange(len(state)), side.error] = side.sign * by
    return move(model, state, step)


def _held(at: Linearization, side: _Sides, distance: Array) -> Held:
    return Held(side.error, at.state[side.run], side.sign * distance, _FIRM * side.sigma)


def _floor(
    model: ReplayModel,
    arc: MeasuredArc,
    at: Linearization,
    side: _Sides,
    state: Array,
    distance: Array,
) -> tuple[Array, Array, Array]:
    """The best states (side, n) at a distance, by how much they cost more, and how far they are."""
    part, last = model.of(side.run), arc.measured.shape[1] - 1
    held = _held(at, side, distance)
    limits = last, _ITERATIONS, _TOLERANCE
    found = gauss_newton(part, take(arc, side.run), state, *limits, held=held)
    done = found.decrement < _TOLERANCE
    best = np.where(done[:, None], move(part, found.at.state, found.step), found.at.state)
    cost = found.at.cost - np.where(done, found.decrement, 0.0)
    rise = cost - (held.miss(part, found.at.state) / held.sigma) ** 2 * ~done - at.cost[side.run]
    return best, rise, distance - np.abs(held.miss(part, best))
