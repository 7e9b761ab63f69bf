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
    knows = ("camera_scale", "image_half_size")
    kind: Literal["pinhole_camera"]
    scale_px: Positive = Field(description="focal length in pixels")
    half_size_px: HalfSize = Field(description="half the width and the height of the image")

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return scale (run,) and half size (run, 2)."""
        runs = len(draws.runs)
        return {
            "camera_scale": np.full(runs, self.scale_px),
            "image_half_size": np.tile(self.half_size_px, (runs, 1)),
        }
