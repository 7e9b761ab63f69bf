"""Residuals of a solution, frame by frame, what they cost, and observations less the far ones."""

from collections.abc import Iterator

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.landmark_model import LandmarkModel, Observations
from debrisest.filters.landmarks.cost import Prior, Unknowns
from debrisest.filters.landmarks.frame_sums import FAR

_BLOCK = 64  # frames whose residuals are held at a time


def residuals(
    model: LandmarkModel, observed: Observations, at: Unknowns, last: int
) -> Iterator[tuple[IntArray, Array, Array, Array]]:
    """Yield epochs up to ``last`` with their normalised residuals, NaN where nothing was seen.

    Of the landmarks (run, epoch, N, r), of what is common (run, epoch, m); and the noise
    (run, epoch, N, r, c), normalised, that the landmarks of an epoch share.
    """
    cores = model.path(model.start(at.parameters)[0], last)
    for first in range(0, last + 1, _BLOCK):
        part = np.arange(first, min(first + _BLOCK, last + 1))
        rows = model.rows(cores[:, part], at.points[:, None], part)
        seen = observed.at(slice(None), part)
        used = seen.seen & at.placed[:, None, :, None]
        yield (
            part,
            np.where(used, (seen.shown - rows.shown) / model.sigma, np.nan),
            np.where(seen.common_seen, (seen.common - rows.common) / model.common_sigma, np.nan),
            rows.shared / model.sigma[:, None],
        )


def without_far(
    model: LandmarkModel, observed: Observations, at: Unknowns, last: int
) -> Observations:
    """Observations less what lies `FAR` from the solution ``at``, up to the epoch ``last``."""
    seen, common_seen = observed.seen.copy(), observed.common_seen.copy()
    for part, residual, common, _ in residuals(model, observed, at, last):
        seen[:, part] &= (np.nansum(residual**2, axis=-1) < FAR)[..., None]
        common_seen[:, part] &= ~(common**2 >= FAR)
    return observed._replace(seen=seen, common_seen=common_seen)


def value(
    model: LandmarkModel, observed: Observations, prior: Prior, at: Unknowns, last: int
) -> Array:
    """Cost (run,) of all frames up to an epoch, each square counted as it is: not linearised."""
    total = prior.at(at)[0]
    for _, residual, common, shared in residuals(model, observed, at, last):
        seen = np.isfinite(residual)
        filled = np.where(seen, residual, 0.0)
        total = total + (filled**2).sum((1, 2, 3)) + np.nansum(common**2, axis=(1, 2))
        if shared.shape[-1]:
            causes = np.where(seen[..., None], shared, 0.0)
            causes = causes.reshape(*causes.shape[:2], -1, causes.shape[-1])
            flat = filled.reshape(*causes.shape[:-1], 1)
            back = np.swapaxes(causes, -1, -2)
            noise = np.eye(causes.shape[-1]) + back @ causes
            pulled = back @ flat
            total = total - (pulled * np.linalg.solve(noise, pulled)).sum((1, 2, 3))
    return np.asarray(total)
