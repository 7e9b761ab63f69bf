"""Time spans as scenarios write them: start, end, an instant, a span."""

import re
from functools import lru_cache
from typing import Annotated

from pydantic import AfterValidator

from debrisest.errors import meant
from debrisest.roles import Window

_NUMBER = r"(\d+(?:\.\d+)?)"
_WINDOW = re.compile(f"^{_NUMBER}-{_NUMBER} s$")
_INSTANT = re.compile(f"^{_NUMBER} s$")


@lru_cache
def window_of(text: str, duration: float) -> Window:
    """Return the time span that ``start``, ``end``, ``a s`` or ``a-b s`` names."""
    if text == "start":
        return (0.0, 0.0)
    if text == "end":
        return (duration, duration)
    if instant := _INSTANT.match(text):
        return (float(instant[1]), float(instant[1]))
    match = _WINDOW.match(text)
    if match is None or float(match[1]) >= float(match[2]):
        raise ValueError(
            "a window is 'start', 'end', an instant such as '50 s' or a span such as "
            f"'900-1400 s', not {text!r}{_meant(text)}"
        )
    return (float(match[1]), float(match[2]))


def _meant(text: str) -> str:
    """Return a question after the window that is written nearly like this, or nothing."""
    numbers = re.findall(_NUMBER, text)
    span = f"{'-'.join(numbers)} s"
    if len(numbers) == 1 or (len(numbers) == 2 and float(numbers[0]) < float(numbers[1])):
        return f" (did you mean {span}?)"
    return meant(text.lower(), ["start", "end"])


def _known_window(text: str) -> str:
    window_of(text, 0.0)
    return text


WindowText = Annotated[str, AfterValidator(_known_window)]
