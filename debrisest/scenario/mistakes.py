"""From what the schema finds wrong to sentences with a file, a line and a suggestion."""

from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from debrisest.errors import allowed_names, meant
from debrisest.scenario.document import Document, KeyPath, Problem

MOST_TOLD = 100
"""Mistakes of one scenario beyond which only their number is told."""
NAMED = ("observers", "sensors", "starts", "estimators")
"""Keys whose entries have names of the user's choice."""


def validated(document: Document, model: Any, folder: Path) -> tuple[Any, list[Problem]]:
    """Return what a model makes of a document, or None and what is wrong with it."""
    try:
        return model.model_validate(document.value, context={"folder": folder}), []
    except ValidationError as error:
        return None, problems_of(error, document, model)


def problems_of(
    error: ValidationError, document: Document, model: type[BaseModel]
) -> list[Problem]:
    """Return the problems of a document that failed the schema, each at the place of its key."""
    found, every = [], error.errors(include_url=False)
    for detail in every[:MOST_TOLD]:
        path = _path_in(document.value, detail)
        name = ".".join(map(str, path)) or "scenario"
        message = _message(detail, model) + _another(path, detail, document)
        found.append(Problem(document.place(path), f"{name}: {message}"))
    if more := len(every) - len(found):
        found.append(Problem(document.place(()), f"and {more} more mistakes; mend these first"))
    return found


def _another(path: KeyPath, detail: ErrorDetails, document: Document) -> str:
    """Return what was meant where that is known from elsewhere in the document only.

    A key may stand below another one; and a slip in the name of a case's or a grid's part makes a
    new part, which lacks what it needs.
    """
    if detail["type"] == "extra_forbidden" and len(path) == 1:
        below = (".".join(map(str, at)) for at in document.places if at[-1:] == path != at)
        deeper = next(below, "")
        return f" (did you mean {deeper}?)" if deeper else ""
    if len(path) < 2 or detail["type"] not in ("union_tag_not_found", "value_error"):
        return ""
    role, name, *_ = path
    named = document.value[role] if role in NAMED else {}
    return meant(str(name), [other for other in named if other != name])


def _path_in(value: Any, detail: ErrorDetails) -> KeyPath:
    """Return the key path of an error: pydantic's location without the names of kinds."""
    location, path = detail["loc"], []
    for index, key in enumerate(location):
        last = index == len(location) - 1
        if isinstance(value, dict) and (key in value or (last and detail["type"] == "missing")):
            value = value.get(key)
        elif isinstance(value, list) and isinstance(key, int) and key < len(value):
            value = value[key]
        else:
            continue
        path.append(key)
    if detail["type"].startswith("union_tag"):
        path.append("kind")
    return tuple(path)


def _message(detail: ErrorDetails, model: type[BaseModel]) -> str:
    kind, context, given = detail["type"], detail.get("ctx", {}), detail["input"]
    if kind == "missing":
        return "this key is missing"
    if kind == "extra_forbidden":
        allowed = _allowed_keys(model, detail["loc"])
        return f"unknown key; {allowed_names(str(detail['loc'][-1]), allowed)}"
    if kind == "union_tag_not_found":
        return "this key is missing: it says which kind of part this is"
    if kind == "union_tag_invalid":
        names = [name.strip("' ") for name in context["expected_tags"].split(",")]
        return f"unknown kind {context['tag']!r}; {allowed_names(context['tag'], names)}"
    if kind == "literal_error":
        names = [n.strip("' ") for n in context["expected"].replace(" or ", ",").split(",")]
        return f"unknown value {given!r}; {allowed_names(str(given), names)}"
    if kind == "value_error":
        return str(context["error"])
    said = detail["msg"][0].lower() + detail["msg"][1:]
    shown = "" if isinstance(given, dict | list) else f" (found {given!r})"
    return said.replace("input should be", "must be") + shown


def _allowed_keys(model: type[BaseModel], location: tuple[str | int, ...]) -> list[str]:
    """Return the keys of the model in which an unknown key was found."""
    models = [model]
    for key in location[:-1]:
        fields = [m.model_fields[str(key)].annotation for m in models if str(key) in m.model_fields]
        tagged = [m for m in models if _tag(m) == key]
        if fields:
            models = [m for annotation in fields for m in _models_in(annotation)]
        elif tagged:
            models = tagged
    return [name for m in models[:1] for name in m.model_fields]


def _tag(model: type[BaseModel]) -> str | None:
    field = model.model_fields.get("kind")
    return get_args(field.annotation)[0] if field else None


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for inner in get_args(annotation) for model in _models_in(inner)]
