"""What keys of a scenario can hold: vectors, positive numbers, unit quaternions, limits."""

from typing import Annotated, Any, TypeVar

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    GetJsonSchemaHandler,
    Tag,
)

from debrisest.roles.docstrings import attribute_docstrings

Window = tuple[float, float]
"""From the first time (included) to the second (excluded), in seconds."""

Vector3 = Annotated[list[float], Field(min_length=3, max_length=3)]
Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]


def _unit_quaternion(q: list[float]) -> list[float]:
    norm = float(np.linalg.norm(q))
    if not abs(norm - 1) < 1e-3:
        raise ValueError(f"a unit quaternion (scalar first) is needed; its norm is {norm:.4g}")
    return [component / norm for component in q]


UnitQuaternion = Annotated[
    list[float],
    Field(min_length=4, max_length=4, json_schema_extra={"$comment": "of norm 1 within 0.001"}),
    AfterValidator(_unit_quaternion),
]


def _ascending(limits: list[float]) -> list[float]:
    if limits[0] > limits[1]:
        raise ValueError("the lower limit comes first")
    return limits


_Number = TypeVar("_Number")
Limits = Annotated[
    list[_Number],
    Field(min_length=2, max_length=2, json_schema_extra={"$comment": "ascending"}),
    AfterValidator(_ascending),
]
"""Lower and upper limit, such as ``Limits[Positive]``."""


def _one_or_each(given: object) -> str:
    return "each" if isinstance(given, list) else "one"


PerAxis = Annotated[
    Annotated[_Number, Tag("one")]
    | Annotated[list[_Number], Field(min_length=3, max_length=3), Tag("each")],
    Discriminator(_one_or_each),
]
"""The same for all three axes, or one for each, such as ``PerAxis[Positive]``."""
PerCoordinate = Annotated[
    Annotated[_Number, Tag("one")]
    | Annotated[list[_Number], Field(min_length=2, max_length=2), Tag("each")],
    Discriminator(_one_or_each),
]
"""The same for both coordinates of a pixel, or one for each."""


class Keys(BaseModel):
    """A mapping of a scenario: unknown keys, infinities and texts for numbers are errors.

    What stands below a key as a text describes it, in the schema and in the guide to scenarios.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)

    @classmethod
    def __get_pydantic_json_schema__(cls, core: Any, handler: GetJsonSchemaHandler) -> Any:
        schema = handler(core)
        keys = handler.resolve_ref_schema(schema).get("properties", {})
        for key, text in attribute_docstrings(cls).items():
            if key in keys:
                keys[key]["description"] = text
        return schema
