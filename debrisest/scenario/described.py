"""The JSON schema of scenario files, in which every key tells its unit and its default."""

from typing import Any

_UNITS = {
    "_rad2_s2": "rad^2/s^2",
    "_rad_s2": "rad/s^2",
    "_deg_s2": "deg/s^2",
    "_m_s2": "m/s^2",
    "_kg_m3": "kg/m^3",
    "_kg_m2": "kg m^2",
    "_n_m": "N m",
    "_deg_s": "deg/s",
    "_rad_s": "rad/s",
    "_m_s": "m/s",
    "_px_s": "px/s",
    "_px2": "px^2",
    "_rad2": "rad^2",
    "_mrad": "mrad",
    "_deg": "deg",
    "_hz": "Hz",
    "_km": "km",
    "_kg": "kg",
    "_px": "px",
    "_m": "m",
    "_s": "s",
}
"""By the end of a key; the longest end that fits comes first."""


def described(schema: dict[str, Any]) -> dict[str, Any]:
    """Return a schema in which the description of each key ends in its unit and its default."""
    models = [schema, *schema.get("$defs", {}).values()]
    for model in models:
        for key, told in model.get("properties", {}).items():
            parts = [told.get("description", ""), _unit(key), _default(told)]
            if text := " ".join(part for part in parts if part):
                told["description"] = text
    return schema


def _unit(key: str) -> str:
    end = next((end for end in _UNITS if key.endswith(end)), "")
    return f"Unit: {_UNITS[end]}." if end else ""


def _default(told: dict[str, Any]) -> str:
    default = told.get("default")
    plain = isinstance(default, bool | int | float | str) and default != ""
    return f"Default: {default}." if plain else ""
