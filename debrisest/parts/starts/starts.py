"""Starts: what is known before the first measurement."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.attitude.points import wahba
from debrisest.clock import Clock
from debrisest.problems.tumbling.attitude import Variances
from debrisest.problems.tumbling.points import MotionVariances
from debrisest.roles import StartPart


class Drawn(StartPart):
    """What a sensor knows of the target at time zero, with the sigma of every quantity."""

    kind: Literal["drawn"]

    def start(self, data: Data, clock: Clock) -> tuple[Data, dict[str, float]]:
        """Return the initial guess by name, and its variance by name."""
        sigmas = [name for name in data if name.startswith("start_") and name.endswith("_sigma")]
        names = [name.removeprefix("start_").removesuffix("_sigma") for name in sigmas]
        guess: Data = {name: data[f"start_{name}"] for name in names}
        return guess, {name: float(data[f"start_{name}_sigma"].flat[0]) ** 2 for name in names}


class FirstSamples(StartPart):
    """Rate from the first differences of the measured attitude, equal moments, no offset.

    Nothing of the truth is used: the body's axes start at the feature frame, and the mean of a few
    differences of a tumbling body's attitude is a biased rate, which the variance must cover.
    """

    needs = ("q_if",)
    kind: Literal["first_samples"]
    samples: Annotated[int, Field(ge=2)] = 5
    variance: Variances

    def start(self, data: Data, clock: Clock) -> tuple[Data, dict[str, float]]:
        """Return the initial guess by name, and its variance by name."""
        q_if = data["q_if"][:, : self.samples]
        turns = quaternion.multiply(quaternion.conjugate(q_if[:, :-1]), q_if[:, 1:])
        steps = clock.steps[: self.samples - 1, None]
        runs = len(q_if)
        guess: Data = {
            "q_ib": q_if[:, 0],
            "q_bf": np.tile([1.0, 0.0, 0.0, 0.0], (runs, 1)),
            "rate_b": (quaternion.log(turns) / steps).mean(axis=1),
            "moments_b": np.full((runs, 3), 1 / np.sqrt(3)),
        }
        return guess, self.variance.model_dump()


class FirstPoints(StartPart):
    """Attitude and rate from the first epochs that have an attitude, equal moments.

    These epochs are measurements too: the guess tells where to begin, and variances should be wide
    enough that it carries practically no information of its own.
    """

    needs = ("measured_point", "known_point_f")
    kind: Literal["first_points"]
    samples: Annotated[int, Field(ge=2)] = 5
    variance: MotionVariances

    def start(self, data: Data, clock: Clock) -> tuple[Data, dict[str, float]]:
        """Return the initial guess by name, NaN without an attitude, and its variance by name."""
        q_if = quaternion.from_matrix(wahba(data["known_point_f"][0], data["measured_point"]))
        rate = _first_rate(q_if, clock.steps, self.samples)
        first = np.argmax(np.isfinite(q_if[..., 0]), axis=-1)
        turned_back = quaternion.exp(-rate * (clock.times[first] - clock.times[0])[:, None])
        guess: Data = {
            "q_if": quaternion.multiply(q_if[np.arange(len(q_if)), first], turned_back),
            "rate_f": rate,
            "log_inertia": np.zeros((len(q_if), 5)),
        }
        return guess, self.variance.model_dump()


def _first_rate(q: Array, steps: Array, samples: int) -> Array:
    """Mean rate (run, 3) of the first ``samples - 1`` pairs of epochs that tell it."""
    turn = quaternion.log(quaternion.multiply(quaternion.conjugate(q[:, :-1]), q[:, 1:]))
    turn /= steps[:, None]
    known = np.isfinite(turn).all(axis=-1)
    used = (known & (np.cumsum(known, axis=-1) < samples))[..., None]
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(used, turn, 0.0).sum(axis=1) / used.sum(axis=1))
