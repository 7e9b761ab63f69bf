"""A target that is known: the features on a body and its inertia."""

from typing import Annotated, Literal
from unicodedata import normalize

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag

from debrisest.arrays import Array, Data
from debrisest.attitude.points import features_frame
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics.inertia_ratios import ratios
from debrisest.parts.truth.each_run import each_run
from debrisest.roles import Keys, SimulationPart, Vector3

MOST_UNEQUAL = 1e6
"""A rod a kilometre long and a metre thick."""


def _possible_inertia(rows: list[float] | list[list[float]]) -> list[float] | list[list[float]]:
    tensor = inertia_tensor(rows)
    if not np.allclose(tensor, tensor.T, rtol=1e-9):
        raise ValueError("the inertia tensor must be symmetric")
    moments = [float(moment) for moment in np.linalg.eigvalsh(tensor)]
    if moments[0] <= 0:
        raise ValueError(f"the principal moments must be positive, they are {_text(moments)}")
    if moments[2] > MOST_UNEQUAL * moments[0]:
        raise ValueError(
            f"the largest principal moment must be at most {MOST_UNEQUAL:g} times the smallest, "
            f"they are {_text(moments)}"
        )
    if moments[2] > (moments[0] + moments[1]) * (1 + 1e-9):
        raise ValueError(
            "no body has this inertia: the largest principal moment must not exceed the sum of "
            f"the two others (triangle inequality), they are {_text(moments)}"
        )
    return rows


def _text(moments: list[float]) -> str:
    return ", ".join(f"{moment:.6g}" for moment in moments)


def inertia_tensor(rows: list[float] | list[list[float]]) -> Array:
    """Return the tensor (3, 3) of three principal moments, or of three rows."""
    given = np.asarray(rows, dtype=float)
    return np.diag(given) if given.ndim == 1 else given


def _rows_or_moments(given: object) -> str:
    return "rows" if isinstance(given, list) and given and isinstance(given[0], list) else "moments"


Inertia = Annotated[
    Annotated[Vector3, Tag("moments")]
    | Annotated[list[Vector3], Field(min_length=3, max_length=3), Tag("rows")],
    Discriminator(_rows_or_moments),
    AfterValidator(_possible_inertia),
]


def _direction(normal: list[float]) -> list[float]:
    if not np.linalg.norm(normal) > 0:
        raise ValueError("an outward normal must not be zero")
    return normal


_RATIO = "true_inertia_ratio"


class Feature(Keys):
    """A recognisable point of the target and the outward normal of the surface there."""

    position_m: Vector3
    """Place, from the centre of mass, body axes."""
    normal: Annotated[Vector3, AfterValidator(_direction)]
    """Normal of the surface there, outward, of any length; not zero."""


def _at_least_three(points: dict[str, Feature]) -> dict[str, Feature]:
    if len(points) < 3:
        raise ValueError(f"an attitude needs at least three features, found {len(points)}")
    if odd := [name for name in points if not (name.strip() and name.isprintable())]:
        raise ValueError(f"{odd[0]!r} is no name: it is empty, or has a tab or an end of a line")
    if len({normalize("NFC", name) for name in points}) < len(points):
        raise ValueError("two features have one name, with an accent as a sign of its own in one")
    first = np.array([feature.position_m for feature in list(points.values())[:3]])
    sides = first[1:] - first[0]
    if np.linalg.matrix_rank(sides, tol=1e-6 * float(np.abs(sides).max() or 1)) < 2:
        raise ValueError("the first three features must not lie on one line")
    return points


class RigidPoints(SimulationPart):
    """Named features on a rigid body; the origin is the centre of mass, the axes are ``b``."""

    truths = ("true_point_b", "true_normal_b", "true_inertia_b", "true_inertia_ratio")
    knows = ("known_point_f",)
    kind: Literal["rigid_points"]
    inertia_kg_m2: Inertia
    """Three moments about the body axes, or the rows of the tensor; its scale does not matter."""
    points: Annotated[dict[str, Feature], AfterValidator(_at_least_three)]
    """Features by name, three or more."""

    @property
    def given(self) -> tuple[str, ...]:
        """Return the datasets that this body gives: ratios only along principal axes."""
        return tuple(name for name in self.can_give() if name != _RATIO or self._principal())

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the body's geometry and inertia, the same in every run."""
        positions = self._positions()
        frame = features_frame(positions)
        same = {
            "known_point_f": (positions - positions[0]) @ frame,
            "true_point_b": positions,
            "true_normal_b": self._normals(),
            "true_inertia_b": inertia_tensor(self.inertia_kg_m2),
        }
        if self._principal():
            same[_RATIO] = ratios(np.diag(same["true_inertia_b"]))
        return {"feature": np.array(list(self.points)), **each_run(same, draws)}

    def _principal(self) -> bool:
        tensor = inertia_tensor(self.inertia_kg_m2)
        return bool(np.all(tensor == np.diag(np.diag(tensor))))

    def _positions(self) -> Array:
        return np.array([feature.position_m for feature in self.points.values()])

    def _normals(self) -> Array:
        normals = np.array([feature.normal for feature in self.points.values()])
        return np.asarray(normals / np.linalg.norm(normals, axis=-1, keepdims=True))
