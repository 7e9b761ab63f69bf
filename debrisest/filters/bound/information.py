"""What measurements tell of the unknowns at epoch 0, gathered epoch by epoch."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.filters.linear_algebra import scaled_inverse


class Information(NamedTuple):
    """Of n unknowns: the matrix (run, n, n), and what it is times the estimate, (run, n)."""

    matrix: Array
    gradient: Array


def gather(
    held: Information, rows: Array, residual: Array, moved: Array
) -> tuple[Array, Array, Array]:
    """Add measurements to what is held.

    Returns errors and sigmas (run, time, n_e) of each epoch, and the covariance (run, n, n) that
    the unknowns have in the end.

    ``rows (run, time, m, n)`` and ``residual (run, time, m)`` have unit noise; ``moved (run, time,
    c, d)`` takes errors of the first d unknowns to c errors of each epoch. The others stay.
    """
    if compiled.available():
        from debrisest.filters.bound.information_loops import gathered

        given = (np.ascontiguousarray(each) for each in (rows, residual, moved))
        error, sigma, root = gathered(*held, *given)
        return error, sigma, root @ np.swapaxes(root, -1, -2)
    runs, epochs, c, d = moved.shape
    error, sigma = np.empty((2, runs, epochs, c + rows.shape[-1] - d))
    for k in range(epochs):
        back = np.swapaxes(rows[:, k], -1, -2)
        held.matrix[:] += back @ rows[:, k]
        held.gradient[:] += (back @ residual[:, k, :, None])[..., 0]
        inverse = scaled_inverse(held.matrix)
        start = (inverse @ held.gradient[..., None])[..., 0]
        error[:, k] = moved_errors(moved[:, k], start)
        sigma[:, k] = moved_sigma(moved[:, k], inverse)
    return error, sigma, inverse


def parts(epochs: int, keep: Sequence[int], longest: int) -> Iterator[slice]:
    """Split epochs into parts no longer than a limit; those that are kept end one."""
    ends = sorted({*range(longest, epochs, longest), *(k + 1 for k in keep), epochs})
    return (slice(first, end) for first, end in zip([0, *ends], ends))


def moved_errors(moved: Array, error: Array) -> Array:
    """Errors ``(..., n_e)`` of an epoch from those of the unknowns (..., n)."""
    d = moved.shape[-1]
    core = (moved @ error[..., :d, None])[..., 0]
    rest = np.broadcast_to(error[..., d:], (*core.shape[:-1], error.shape[-1] - d))
    return np.concatenate([core, rest], axis=-1)


def moved_sigma(moved: Array, covariance: Array) -> Array:
    """Sigmas ``(..., n_e)`` of an epoch from the covariance of the unknowns (..., n, n)."""
    d = moved.shape[-1]
    own = ((moved @ covariance[..., :d, :d]) * moved).sum(-1)
    rest = np.diagonal(covariance, 0, -2, -1)[..., d:]
    rest = np.broadcast_to(rest, (*own.shape[:-1], rest.shape[-1]))
    return np.asarray(np.sqrt(np.concatenate([own, rest], axis=-1)))


def moved_covariance(moved: Array, covariance: Array) -> Array:
    """Covariance ``(run, n_e, n_e)`` of the errors of an epoch from that of the unknowns."""
    d = moved.shape[-1]
    top = moved @ covariance[:, :d]
    corner = top[..., :d] @ np.swapaxes(moved, -1, -2)
    side = top[..., d:]
    upper = np.concatenate([0.5 * (corner + np.swapaxes(corner, -1, -2)), side], axis=-1)
    lower = np.concatenate([np.swapaxes(side, -1, -2), covariance[:, d:, d:]], axis=-1)
    return np.concatenate([upper, lower], axis=-2)
