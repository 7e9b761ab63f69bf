"""The models of a scenario file, with the catalog's kinds in their places."""

from collections.abc import Sequence
from functools import cache, reduce
from operator import or_
from typing import Annotated, Any

from pydantic import Field, create_model

from debrisest.catalog import CATALOG, kind_of
from debrisest.roles import Keys, Part
from debrisest.scenario.names import PartName
from debrisest.scenario.schema import Estimator, Measured, Scenario


def scenario_model(base: type[Scenario] = Scenario) -> Any:
    """Return the scenario's model with the catalog's kinds in their places."""
    return _scenario_model(base, _catalog())


def measured_model() -> Any:
    """Return the model of `measured` alone, with the catalog's kinds."""
    return _measured_model(_catalog())


def _catalog() -> tuple[tuple[type[Part], ...], ...]:
    """Return what the models are made of: they are made anew where a plug-in changes it."""
    return tuple(map(tuple, CATALOG.values()))


@cache
def _scenario_model(base: type[Scenario], _: Any) -> Any:
    estimator = _filled(Estimator, _optional("recovery", "problem", "start", "filter"))
    named = {role: _by_name(_kinds(role)) for role in ("observers", "sensors", "starts")}
    alone = _optional("target", "orbit", "motion", "measured")
    return _filled(base, alone | named | {"estimators": _by_name(estimator)})


@cache
def _measured_model(_: Any) -> Any:
    return _filled(Measured, {"measured": _kinds("measured")})


def _filled(base: type[Keys], kinds: dict[str, Any]) -> Any:
    """Return a model with what some of its keys may hold, which say the same and default so."""
    places = {name: (value, base.model_fields[name]) for name, value in kinds.items()}
    create: Any = create_model
    return create(base.__name__, __base__=base, __doc__=base.__doc__, **places)


def _optional(*roles: str) -> dict[str, Any]:
    return {role: _kinds(role) | None for role in roles}


def _by_name(value: Any) -> Any:
    return dict[PartName, value]


def _kinds(role: str) -> Any:
    parts: Sequence[Any] = CATALOG[role]
    if len({kind_of(part) for part in parts}) != len(parts):
        raise ValueError(f"the catalog has two parts of one kind in {role!r}")
    union = reduce(or_, parts)
    return Annotated[union, Field(discriminator="kind")] if len(parts) > 1 else union
