"""Numbers as people write them in a table, strictly."""

import math
import re

import numpy as np

from debrisest.arrays import Array, BoolArray

LARGEST = 1e12
"""No quantity in its unit is larger: seconds since 1970, metres, pixels."""

_PLAIN = re.compile(r"[0-9eE+.\- \n]*")
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")


def to_numbers(fields: list[str], decimal: str = ".") -> tuple[Array, BoolArray]:
    """Return the values of fields, and which of them are no numbers.

    Empty and ``nan`` are NaN: not observed. Python's own extensions (``1_000``, ``infinity``, other
    scripts' digits) are no numbers, nor is what is not finite or beyond `LARGEST`.
    """
    joined = "\n".join(fields)
    if decimal == ",":
        joined = joined.replace(",", ".")
    if _PLAIN.fullmatch(joined):
        try:
            values = np.fromiter(map(float, joined.split("\n")), float, len(fields))
            return values, np.asarray(~(np.abs(values) <= LARGEST))
        except ValueError:
            pass  # an empty field, or one that has to be found
    values = np.array([_number(field) for field in joined.split("\n")])
    return np.where(np.isinf(values), np.nan, values), np.isinf(values)


def wrong_number(field: str, decimal: str, delimiter: str) -> str:
    """Return what is wrong with a field that is no number, and what to write."""
    shown = repr(field.strip()[:30])
    if _NUMBER.fullmatch(field.strip().replace(decimal, ".")):
        return f"{shown} is beyond {LARGEST:g}: not a quantity in this unit"
    if "," in field and delimiter == ",":
        return f"{shown} is not a number; decimal commas need semicolons between the columns"
    if re.search(r"[0-9][.,' ][0-9]{3}([.,' ]|$)", field):
        return f"{shown} is not a number; write it without separators of thousands"
    return f"{shown} is not a number; leave the cell empty where nothing was observed"


def _number(field: str) -> float:
    """Value of one field, NaN where not observed, inf where it is no number."""
    text = field.strip()
    if text.lower() in ("", "nan"):
        return math.nan
    value = float(text) if _NUMBER.fullmatch(text) else math.inf
    return value if abs(value) <= LARGEST else math.inf
