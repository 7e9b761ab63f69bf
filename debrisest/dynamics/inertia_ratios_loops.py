"""Ratios of inertia of one body, for compiled loops; formulas are those of `inertia_ratios`."""

import math

from debrisest.attitude.vector_loops import Vector
from debrisest.compiled import compiled
from debrisest.dynamics.inertia_ratios import LARGEST_CHANGE, LARGEST_SLOPE


@compiled
def slopes(k1: float, k2: float) -> Vector:
    """Return ``sx, sy, sz``."""
    sx = -math.expm1(-k2) * math.exp(-k1)
    sy = -math.expm1(k1 + k2) * math.exp(-k2)
    return sx, sy, math.expm1(k1) * math.exp(k2)


@compiled
def moved(k1: float, k2: float, change1: float, change2: float) -> tuple[float, float]:
    """Return the ratios after a correction, as `inertia_ratios.move`."""
    sx, _, sz = slopes(k1, k2)
    by_x, by_z = by_ratios(k1, k2)
    sx = reached(sx, by_x[0] * change1 + by_x[1] * change2)
    sz = reached(sz, by_z[0] * change1 + by_z[1] * change2)
    both = math.log1p(sx * sz)
    return math.log1p(sz) - both, both - math.log1p(-sx)


@compiled
def by_ratios(k1: float, k2: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the derivatives of sx and sz."""
    sx, _, sz = slopes(k1, k2)
    product = math.exp(k1 + k2)
    return (-sx, 1.0 / product), (product, sz)


@compiled
def reached(slope: float, rise: float) -> float:
    """Return the slope that a correction reaches, within its limits."""
    rise = min(max(rise, -LARGEST_CHANGE), LARGEST_CHANGE)
    return min(max(slope + rise, -LARGEST_SLOPE), LARGEST_SLOPE)
