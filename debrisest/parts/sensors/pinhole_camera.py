"""The camera of satellites that observe a piece of debris."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.roles import Positive, SimulationPart

HalfSize = Annotated[list[Positive], Field(min_length=2, max_length=2)]


class PinholeCamera(SimulationPart):
    """The camera that all satellites have."""

    needs = ("observer_position",)
    knows = ("focal_px", "image_half_size")
    kind: Literal["pinhole_camera"]
    focal_px: Positive
    """Focal length in pixels."""
    half_size_px: HalfSize
    """Half the width and half the height of the image."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return focal length (run,) and half size (run, 2)."""
        runs = len(draws.runs)
        return {
            "focal_px": np.full(runs, self.focal_px),
            "image_half_size": np.tile(self.half_size_px, (runs, 1)),
        }
