"""Write the tables of keys in ``docs/scenario.md`` from the schema of scenario files.

``python scripts/scenario_guide.py`` fills what stands between ``<!-- keys of X -->`` and
``<!-- end -->``: X is a kind, or a model of the schema such as ``Table``. What is around them is
written by hand.
"""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from debrisest.scenario.models import scenario_model
from debrisest.scenario.schema import ScenarioFile

GUIDE = Path(__file__).parent.parent / "docs" / "scenario.md"
HEAD = ("| key | value | default | meaning |", "|---|---|---|---|")
MOST_LISTED = 12
_BLOCK = re.compile(r"(<!-- keys of (\w+) -->\n).*?(<!-- end -->)", re.S)
Schema = dict[str, Any]


def models() -> dict[str, Schema]:
    """Return the models of the schema, parts by their kind, the others by their name."""
    schema = scenario_model(ScenarioFile).model_json_schema()
    named = {"ScenarioFile": schema} | schema["$defs"]
    return {
        model["properties"].get("kind", {}).get("const", name): model
        for name, model in named.items()
    }


def written(text: str, known: dict[str, Schema]) -> str:
    """Return the guide with its tables of keys as the models have them."""
    apart = {name for _, name, _ in _BLOCK.findall(text)}
    inner = {name: model for name, model in known.items() if name not in apart}

    def block(found: re.Match[str]) -> str:
        rows = _rows(known[found[2]], inner)
        return "\n".join([found[1], *HEAD, *rows, "", found[3]])

    return _BLOCK.sub(block, text)


def _rows(model: Schema, inner: dict[str, Schema], before: str = "") -> Iterator[str]:
    """Yield a row for each key, and for those of the models that it holds."""
    for key, told in model["properties"].items():
        if key == "kind":
            continue
        default = "required" if key in model.get("required", ()) else _default(told)
        yield f"| `{before}{key}` | {value(told)} | {default} | {told['description']} |"
        for name, prefix in _held(told):
            yield from _rows(inner.get(name, {"properties": {}}), inner, f"{before}{key}.{prefix}")


def _held(told: Schema) -> Iterator[tuple[str, str]]:
    """Yield the models that a key holds, and what stands before their keys: where by name, NAME."""
    for one in (told, *told.get("anyOf", ())):
        if "$ref" in one:
            yield _name(one), ""
        if "$ref" in one.get("items", ()):
            yield _name(one["items"]), ""
        if "$ref" in one.get("additionalProperties", ()):
            yield _name(one["additionalProperties"]), "NAME."


def _name(one: Schema) -> str:
    return str(one["$ref"].rpartition("/")[2])


def _default(told: Schema) -> str:
    default = told.get("default")
    if default is None:
        return "none"
    if isinstance(default, dict) and default:
        return "see its keys"
    return f"`{default}`" if isinstance(default, str) and default else f"`{json.dumps(default)}`"


def value(told: Schema) -> str:
    """Return in words what a key may hold."""
    either = [one for one in told.get("anyOf", told.get("oneOf", ())) if one.get("type") != "null"]
    if "discriminator" in told or any("discriminator" in one for one in either):
        return "one part"
    if either:
        return ", or ".join(map(value, either))
    if "enum" in told:
        names = told["enum"]
        few = len(names) <= MOST_LISTED
        return ", ".join(f"`{name}`" for name in names) if few else "a name from the list below"
    words = {"array": _list, "object": _mapping, "number": _number, "integer": _number}
    kind = told.get("type", "")
    said = words[kind](told) if kind in words else {"string": "text"}.get(kind, kind or "mapping")
    return f"{said}, {told['$comment']}" if "$comment" in told else said


def _number(told: Schema) -> str:
    low, high = told.get("minimum"), told.get("maximum")
    above, below = told.get("exclusiveMinimum"), told.get("exclusiveMaximum")
    if above == 0 and high is below is None:
        said = "positive"
    elif low is not None and high is not None:
        said = f"{low} to {high}"
    else:
        limits = {"from": low, "above": above, "at most": high, "below": below}
        said = ", ".join(f"{word} {end}" for word, end in limits.items() if end is not None)
    whole = "integer" if told["type"] == "integer" else ""
    return ", ".join(part for part in (whole, said) if part) or "number"


def _list(told: Schema) -> str:
    one, count = told.get("items", {}), told.get("minItems")
    each = value(one) if one else "values"
    if count is None or count != told.get("maxItems"):
        return f"list of {_many(each)}"
    return f"{count} rows of {each}" if one["type"] == "array" else f"{count} {_many(each)}"


def _many(one: str) -> str:
    """Return several of what is said of one: numbers, unless it is something else."""
    noun = re.match("number|integer|text|mapping|list|values|a name|`|[0-9]+ n", one)
    if noun is None:
        return f"numbers, each {one}"
    if one.startswith("integer, "):
        return one.replace("integer,", "integers, each", 1)
    plural = noun[0] in ("number", "integer", "text", "mapping", "list")
    return one.replace(noun[0], f"{noun[0]}s", 1) if plural else one


def _mapping(told: Schema) -> str:
    patterns = [*told.get("patternProperties", {}).values()]
    inner = patterns[0] if patterns else told.get("additionalProperties", {})
    return f"name: {value(inner)}" if isinstance(inner, dict) and inner else "mapping"


if __name__ == "__main__":
    GUIDE.write_text(written(GUIDE.read_text(encoding="utf-8"), models()), encoding="utf-8")
