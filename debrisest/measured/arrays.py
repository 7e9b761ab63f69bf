"""Arrays of measurements that a person gives: whether they fit each other."""

from collections.abc import Iterator, Mapping

import numpy as np

from debrisest.arrays import Array
from debrisest.errors import UserError

_SHAPES = {"points": (None, None, 3), "q": (None, 4), "rates": (None, 3)}
"""None is any length; the first is that of the times."""


def require_fitting(
    times: Array, measured: Mapping[str, Array], sigma: Array | None, model: Array | None
) -> None:
    """Raise UserError with all that does not fit: kinds, shapes, order of times, size of sigma."""
    problems = [*_of_times(times)]
    if len(measured) != 1:
        given = ", ".join(measured) or "nothing"
        problems.append(f"give one of points, q and rates, not {given}")
    for name, values in measured.items():
        problems += _of_values(name, values, times, sigma, model)
    if model is not None and "points" not in measured:
        problems.append("model: places of points are for points only; leave it out")
    if problems:
        raise UserError(problems)


def _of_times(times: Array) -> Iterator[str]:
    if times.ndim != 1 or len(times) < 2:
        yield f"times: shape {times.shape}; needed: (time,), two epochs or more"
    elif not (np.isfinite(times).all() and (np.diff(times) > 0).all()):
        yield "times: must be finite and increase, in seconds"


def _of_values(
    name: str, values: Array, times: Array, sigma: Array | None, model: Array | None
) -> Iterator[str]:
    wanted = _SHAPES[name]
    fits = values.ndim == len(wanted) and all(
        length in (None, there) for length, there in zip(wanted, values.shape)
    )
    if not fits or values.shape[0] != times.size:
        axes = "(time, feature, 3)" if name == "points" else f"(time, {wanted[-1]})"
        yield f"{name}: shape {values.shape}; needed: {axes} with {times.size} epochs"
        return
    if sigma is not None:
        yield from _of_sigma(name, values, sigma)
    if model is not None and name == "points" and model.shape != values.shape[1:]:
        yield f"model: shape {model.shape}; needed: {values.shape[1:]}, a place for each point"


def _of_sigma(name: str, values: Array, sigma: Array) -> Iterator[str]:
    """A number, one for each measurement, or of each component: of points, else a covariance."""
    whole = values.shape if name == "points" else (len(values), 3, 3)
    if sigma.shape not in ((), values.shape[:-1], whole):
        yield f"sigma: shape {sigma.shape}; needed: a number, {values.shape[:-1]} or {whole}"
        return
    if sigma.shape == whole and name != "points":
        sigma = np.diagonal(sigma, 0, -2, -1)
    of_measured = sigma[np.isfinite(values).all(axis=-1)] if sigma.ndim else sigma
    if not (np.isfinite(of_measured) & (of_measured > 0.0)).all():
        yield "sigma: must be finite and positive for all that is measured; None: not known"
