"""Starts: what is known before the first measurement."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.problems.tumbling_attitude import Variances
from debrisest.roles import StartPart


class Drawn(StartPart):
    """What a sensor knows of the target at time zero, with the sigma of every quantity."""

    needs = ("start_position",)
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
        runs = len(q_if)
        guess: Data = {
            "q_ib": q_if[:, 0],
            "q_bf": np.tile([1.0, 0.0, 0.0, 0.0], (runs, 1)),
            "rate_b": quaternion.log(turns).mean(axis=1) / clock.step,
            "moments_b": np.full((runs, 3), 1 / np.sqrt(3)),
        }
        return guess, self.variance.model_dump()
