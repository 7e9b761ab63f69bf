"""A start that takes the target's direction from the first image."""

from typing import Literal

import numpy as np

from debrisest.arrays import BoolArray, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.parts.starts.guess import FromGuess


class FirstImage(FromGuess):
    """The first guess, but for the position: behind the middle of the first image's points.

    The direction is that of their median pixel, the distance the measured range. This needs the
    camera's attitude, and is much better than a drawn direction.
    """

    needs = (
        *("start_relative_position_h", "known_q_hc", "focal_px"),
        *("measured_pixel", "measured_range"),
    )
    kind: Literal["first_image"]

    def start(self, data: Data, clock: Clock) -> tuple[Data, Data]:
        """Return the initial guess by name, and its variance by name."""
        pixels = data["measured_pixel"][:, 0, 0]
        seen: BoolArray = np.asarray(np.isfinite(pixels).all(-1).any(-1))
        middle = np.nanmedian(np.where(seen[:, None, None], pixels, 0.0), axis=1)
        slope = middle / data["focal_px"][:, None]
        view = np.concatenate([slope, np.ones_like(slope[:, :1])], axis=-1)
        view *= (data["measured_range"][:, 0] / np.linalg.norm(view, axis=-1))[:, None]
        position = -quaternion.rotate(data["known_q_hc"][:, 0], view)
        guess, variance = super().start(data, clock)
        known = guess["relative_position_h"]
        return guess | {"relative_position_h": np.where(seen[:, None], position, known)}, variance
