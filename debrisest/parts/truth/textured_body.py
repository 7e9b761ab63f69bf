"""A target that cameras show: a closed mesh with a pattern on it."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.parts.truth.each_run import each_run
from debrisest.roles import Positive, SimulationPart
from debrisest.vision.bodies import BODIES
from debrisest.vision.polyhedron import mass_properties


class TexturedBody(SimulationPart):
    """A body of one density; the origin is its centre of mass, the axes are ``b``."""

    truths = (
        "true_vertex_b", "true_triangle", "true_albedo", "true_texture", "true_volume",
        "true_inertia_b",
    )  # fmt: skip
    kind: Literal["textured_body"]
    name: Literal["h10", "panelled_satellite", "simulator", "box"]
    """A rocket stage of 11.53 m x 2.66 m with a nozzle; a box with two panels 8 cm thick and a
    dish; a laboratory's disc with boxes; a box of 2 m x 1.6 m x 1.2 m."""
    density_kg_m3: Positive = 1000.0
    """Density."""
    texture_m: Positive = 0.6
    """Width of the pattern's largest spots."""
    texture_seed: Annotated[int, Field(ge=0, lt=2**32)] = 1
    """Which pattern."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return mesh, pattern, volume and inertia, the same in every run."""
        solid = BODIES[self.name]()
        volume, centre, inertia = mass_properties(solid.vertices, solid.triangles)
        same = {
            "true_vertex_b": solid.vertices - centre,
            "true_triangle": solid.triangles.astype(float),
            "true_albedo": solid.albedo,
            "true_texture": np.array([self.texture_m, self.texture_seed]),
            "true_volume": np.array(volume),
            "true_inertia_b": self.density_kg_m3 * inertia,
        }
        return each_run(same, draws)
