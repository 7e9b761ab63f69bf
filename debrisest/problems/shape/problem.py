"""Volume, centre of mass and inertia of a body of constant density, from its images.

Pesce et al. 2017, section 7: density 1 g/cm3 unless another one, or the mass, is given. The axes
``r`` are those of the structure from motion. Without a scale only ratios are told.
"""

from typing import Literal

import numpy as np
from pydantic import model_validator

from debrisest.arrays import Array, BoolArray, Data
from debrisest.clock import Clock
from debrisest.dynamics import inertia_ratios
from debrisest.filters.estimates import Estimates
from debrisest.problems.shape.model import ShapeModel
from debrisest.problems.shape.score import relative_spread, scores
from debrisest.roles import NonNegative, Positive, ProblemPart, Window

_MATRIX = np.array([[4, 7, 8], [7, 5, 9], [8, 9, 6]])
"""Where the components of the tensor lie in the state."""


class ConstantDensityShape(ProblemPart):
    """The problem of this file; the mass, where it is known, takes the place of the density."""

    needs = (
        *("measured_image", "found_camera_matrix", "found_lens_distortion", "rig_rotation"),
        *("rig_translation", "view_rotation", "view_translation", "cloud_point_r", "scale_spread"),
    )
    model_kind = "shape_model"
    kind: Literal["constant_density_shape"]
    density_kg_m3: Positive = 1000.0
    """Density, the same everywhere."""
    mass_kg: Positive | None = None
    """Mass of the body, in the place of the density."""
    known_length_m: Positive | None = None
    """Longest distance between two points of the body; it gives the scale."""
    known_length_sigma_m: NonNegative = 0.0
    """Standard deviation of the known length."""

    @model_validator(mode="after")
    def _one_of_two(self) -> "ConstantDensityShape":
        if self.mass_kg is not None and "density_kg_m3" in self.model_fields_set:
            raise ValueError("mass_kg and density_kg_m3 exclude each other")
        return self

    def measurements(self, data: Data) -> Array:
        """Return nothing (run, time, 0): the measurements are images, which the model has."""
        return np.empty((len(data["run"]), len(data["time_s"]), 0))

    def model(self, data: Data, clock: Clock) -> ShapeModel:
        """Return images and their places."""
        length = self.known_length_m
        return ShapeModel(data, None if length is None else (length, self.known_length_sigma_m))

    def unpack(self, filtered: Estimates) -> Data:
        """Return volume, centre, inertia, principal moments and ratios, each with its sigma.

        Without a scale all but axes and ratios are NaN. A known mass makes the sigma of the
        inertia an upper limit: errors of the scale count two times then, not five.
        """
        state, sigma = filtered.state[:, -1], filtered.sigma[:, -1]
        density = self._density(state[:, 0])
        inertia, spread = state[:, _MATRIX] * density, sigma[:, _MATRIX] * density
        moments, axes = _principal(inertia)
        relative = relative_spread(inertia, spread)[:, None] * np.ones(3)
        across = relative * moments
        scale = np.where(filtered.counts["scaled"] > 0, 1.0, np.nan)
        estimated = {
            "volume": (state[:, 0], sigma[:, 0]),
            "centre_r": (state[:, 1:4], sigma[:, 1:4]),
            "body_inertia_r": (inertia, spread),
            "principal_moments": (moments, across),
        }
        result: Data = {"principal_axes_r": axes, "moment_ratios": inertia_ratios.ratios(moments)}
        result["moment_ratios_sigma"] = np.hypot(relative[:, :2], relative[:, 1:])
        result["body_mass"] = scale * state[:, 0] * density[:, 0, 0]
        for name, pair in estimated.items():
            for end, value in zip(("", "_sigma"), pair):
                result[f"{name}{end}"] = value * scale.reshape(-1, *[1] * (value.ndim - 1))
        return result

    def _density(self, volume: Array) -> Array:
        """Return the density (run, 1, 1)."""
        if self.mass_kg is None:
            return np.full((len(volume), 1, 1), self.density_kg_m3)
        return np.asarray(self.mass_kg / volume)[:, None, None]

    def assess(self, data: Data, scored: Window) -> Data:
        """Return relative errors in the true body's axes, if it is known."""
        return scores(data)


def _principal(inertia: Array) -> tuple[Array, Array]:
    """Return ascending moments (run, 3) and axes (run, 3, 3), NaN where the tensor is."""
    known: BoolArray = np.asarray(np.isfinite(inertia).all((1, 2)))
    moments, axes = np.linalg.eigh(np.where(known[:, None, None], inertia, np.eye(3)))
    axes = axes * np.sign(np.linalg.det(axes))[:, None, None]
    return np.where(known[:, None], moments, np.nan), np.where(known[:, None, None], axes, np.nan)
