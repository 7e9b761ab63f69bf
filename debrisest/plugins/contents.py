"""What a plug-in must hold: parts of the roles that there are, and the quantities they add."""

import inspect
from collections.abc import Iterator, Mapping, Sequence
from types import ModuleType
from typing import Any, get_args

from debrisest.catalog import CATALOG, kind_of
from debrisest.errors import allowed_names
from debrisest.quantity import Quantity
from debrisest.roles import Part, SimulationPart
from debrisest.vocabulary import VOCABULARY


def parts_of(module: ModuleType) -> list[Any]:
    """Return the list ``PARTS`` of a module, or else every part in it that has a kind."""
    if hasattr(module, "PARTS"):
        return list(module.PARTS)
    return [
        value
        for value in vars(module).values()
        if _is_part(value) and value.__module__ == module.__name__ and "kind" in value.model_fields
    ]


def quantities_of(module: ModuleType) -> Mapping[str, Quantity]:
    """Return what a module adds to the vocabulary."""
    return getattr(module, "QUANTITIES", {})


def problems_in(module: ModuleType) -> Iterator[str]:
    """Yield why a module is no plug-in, each problem with its place."""
    for name, kind in (("PARTS", list), ("QUANTITIES", dict)):
        if not isinstance(getattr(module, name, kind()), kind):
            yield f"{module.__file__}: {name} must be a {kind.__name__}"
            return
    parts, quantities = parts_of(module), quantities_of(module)
    if not parts:
        yield (
            f"{module.__file__}: no parts here; a part is a subclass of a role in "
            'debrisest.roles, with kind: Literal["its_name"]'
        )
    for index, part in enumerate(parts):
        wrong = _wrong(part, parts[:index]) or _undeclared(part, quantities)
        if wrong:
            yield f"{_place(part, module)}: {getattr(part, '__name__', part)}: {wrong}"
    for name, quantity in quantities.items():
        if name in VOCABULARY:
            yield f"{module.__file__}: QUANTITIES: {name} exists already; choose another name"
        elif not isinstance(quantity, Quantity):
            yield f"{module.__file__}: QUANTITIES: {name} must be a debrisest.quantity.Quantity"


def _wrong(part: Any, before: Sequence[Any]) -> str:
    """Return what is wrong with a part, beside those that come before it."""
    if not _is_part(part):
        return "not a subclass of a role in debrisest.roles"
    field = part.model_fields.get("kind")
    if field is None or [type(name) for name in get_args(field.annotation)] != [str]:
        return 'this part needs a key of its own name, kind: Literal["its_name"]'
    role = getattr(part, "role", None)
    if role not in CATALOG:
        return f"unknown role {role!r}; {allowed_names(str(role), CATALOG)}"
    if inspect.isabstract(part):
        return f"this part lacks {', '.join(sorted(part.__abstractmethods__))}"
    for other in [*CATALOG[role], *(one for one in before if _is_part(one))]:
        if other.role == role and kind_of(other) == kind_of(part):
            return f"kind {kind_of(part)!r} of {role} exists already, in {_place(other)}"
    return ""


def _undeclared(part: type[Part], quantities: Mapping[str, Quantity]) -> str:
    """Return which datasets a simulation gives that neither the vocabulary has nor the plug-in."""
    if not issubclass(part, SimulationPart):
        return ""
    names = {*part.can_give(), *part.extends} - VOCABULARY.keys() - quantities.keys()
    return f"QUANTITIES must declare {', '.join(sorted(names))}, which it gives" if names else ""


def _is_part(value: Any) -> bool:
    return isinstance(value, type) and issubclass(value, Part)


def _place(part: Any, module: ModuleType | None = None) -> str:
    """Return file and line of a class, or the file of the module that names it."""
    try:
        return f"{inspect.getsourcefile(part)}:{inspect.getsourcelines(part)[1]}"
    except (OSError, TypeError):
        return str(module.__file__ if module else part.__module__)
