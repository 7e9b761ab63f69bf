"""How much better a filter with more process noise foretells what a track has used.

Beside the track run two Kalman filters, one of which expects the stated process noise and one more;
both take over which detections are the target's. No test of one model against another is more
powerful than the ratio of their likelihoods (Neyman and Pearson 1933). Its mean is one if the first
is right, so that it exceeds 1 / p with a probability of p at most, however long the data are.
Where the ratio decides nothing, their mixture is an estimate whose covariance has both.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.association.update import Correction
from debrisest.filters.linear_algebra import solve

FACTORS = np.array([1.0, 3.0])
"""Of the sigma of the process noise, in the two filters."""


class Bank(NamedTuple):
    """Two filters."""

    apart: Array
    """What they have for a state, less that of the track, (run, filter, n)."""
    covariance: Array
    """(run, filter, n, n)."""


def begun(covariance: Array) -> Bank:
    """Return the bank at a start, whose covariance (run, n, n) both have."""
    every = np.repeat(covariance[:, None], len(FACTORS), axis=1)
    return Bank(np.zeros(every.shape[:-1]), every)


def predicted(bank: Bank, transition: Array, noise: Array) -> Bank:
    """Return it an epoch later."""
    moved = transition[:, None]
    covariance = moved @ bank.covariance @ np.swapaxes(moved, -2, -1)
    covariance = covariance + FACTORS[:, None, None] ** 2 * noise
    return Bank((moved @ bank.apart[..., None])[..., 0], covariance)


def corrected(bank: Bank, made: Correction) -> tuple[Bank, Array]:
    """Return it after an update of the track, and the logarithmic likelihoods (run, filter).

    The combined innovation of a sensor is taken for what the target shows times the probability
    that it is seen, with the spread that the update has for it.
    """
    seen = made.trusted[:, :1, :, None]
    h = seen * made.shown[:, :1]
    unseen = np.where(seen > 0.0, 0.0, made.total[:, :1] - made.own[:, :1])
    noise = made.spread[:, :1] + unseen
    cross = h @ bank.covariance
    total = cross @ np.swapaxes(h, -2, -1) + noise
    innovation = made.innovation[:, :1] - (h @ bank.apart[..., None])[..., 0]
    solved = solve(total, np.concatenate([cross, innovation[..., None]], axis=-1))
    gain, white = solved[..., :-1], solved[..., -1]
    kept = np.eye(h.shape[-1]) - np.swapaxes(gain, -2, -1) @ h
    covariance = kept @ bank.covariance @ np.swapaxes(kept, -2, -1)
    covariance = covariance + np.swapaxes(gain, -2, -1) @ noise @ gain
    moved = (innovation[..., None, :] @ gain)[..., 0, :]
    moved = moved - (made.innovation[:, :1, None] @ made.gain[:, :1])[..., 0, :]
    likelihood = -0.5 * ((innovation * white).sum(-1) + np.linalg.slogdet(total)[1])
    return Bank(bank.apart + moved, covariance), likelihood


def mixed(bank: Bank, likelihood: Array, state: Array) -> tuple[Array, Array]:
    """Return mean (run, n) and covariance (run, n, n) where either filter may be right.

    Both are as likely before the data, and then by their ``likelihood (run, filter)`` so far
    (Magill 1965); ``state`` is that of the track.
    """
    weight = np.exp(likelihood - likelihood.max(-1, keepdims=True))
    weight = weight / weight.sum(-1, keepdims=True)
    mean = (weight[..., None] * bank.apart).sum(1)
    apart = bank.apart - mean[:, None]
    spread = bank.covariance + apart[..., :, None] * apart[..., None, :]
    return state + mean, (weight[..., None, None] * spread).sum(1)


def log_ratio(likelihood: Array) -> Array:
    """Return by how much the logarithmic likelihood (run, filter) is higher with more noise."""
    return np.asarray(likelihood[:, 1] - likelihood[:, 0])
