"""What a model takes for granted, and what is said where the data speak against it."""

from typing import NamedTuple


class Doubt(NamedTuple):
    """A parameter that a model holds at zero, and what it means that the data pull it away."""

    reason: str
    """With ``{value}``, in sigmas, and ``{size}``, what it would be."""
    scale: float
    """From radians and the like to the unit of the reason."""
