"""Why a run gave no result, in a sentence that says which part of the scenario it is about."""

from collections.abc import Iterator
from contextlib import contextmanager

from debrisest.catalog import kind_of
from debrisest.errors import UserError
from debrisest.roles import Part

_TOLD = (ValueError, UserError)
"""Raised on purpose, with a sentence for a person."""


@contextmanager
def about(path: str, part: Part) -> Iterator[None]:
    """Note on whatever is raised within which part of the scenario raised it."""
    try:
        yield
    except Exception as error:
        error.add_note(f"{path} ({kind_of(type(part))})")
        raise


def reason(error: Exception) -> str:
    """Return why a run failed, the part first; what nobody foresaw is said to be a mistake."""
    said = str(error) or "no more is known"
    if type(error) not in _TOLD:
        said = (
            f"{type(error).__name__} {said}; this is a mistake of debrisest or of a plug-in: "
            "please report it"
        )
    return ": ".join([*getattr(error, "__notes__", []), said])
