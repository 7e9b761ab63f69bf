"""A start from the first attitudes that a recovery gives."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.problems.tumbling.attitude import Variances
from debrisest.roles import StartPart


class FirstSamples(StartPart):
    """Rate from the first differences of the measured attitude, equal moments, no offset.

    Nothing of the truth is used: the body's axes start at the feature frame, and the mean of a few
    differences of a tumbling body's attitude is a biased rate, which the variance must cover.
    """

    needs = ("q_if",)
    guesses = ("q_ib", "q_bf", "rate_b", "moments_b")
    kind: Literal["first_samples"]
    samples: Annotated[int, Field(ge=2)] = 5
    """Epochs of which the rate is taken."""
    variance: Variances
    """Variances of the start."""

    def start(self, data: Data, clock: Clock) -> tuple[Data, Data]:
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
        known = self.variance
        each = zip(guess, (known.q_ib, known.q_bf, known.rate_rad2_s2, known.moments))
        return guess, {name: np.full(guess[name].shape, variance) for name, variance in each}
