"""What a scenario can name: the base of every part, and what each role must be able to do."""

from debrisest.roles.estimator import FilterPart, Given, ProblemPart, RecoveryPart, StartPart
from debrisest.roles.keys import (
    Keys,
    Limits,
    NonNegative,
    PerAxis,
    PerCoordinate,
    Positive,
    UnitQuaternion,
    Vector3,
    Window,
)
from debrisest.roles.part import Part
from debrisest.roles.source import SimulationPart, SourcePart

__all__ = [
    "FilterPart",
    "Given",
    "Keys",
    "Limits",
    "NonNegative",
    "Part",
    "PerAxis",
    "PerCoordinate",
    "Positive",
    "ProblemPart",
    "RecoveryPart",
    "SimulationPart",
    "SourcePart",
    "StartPart",
    "UnitQuaternion",
    "Vector3",
    "Window",
]
