"""Why a run gave no result, in a sentence that says which part of the scenario it is about."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from traceback import extract_tb

from numpy.linalg import LinAlgError

from debrisest.catalog import kind_of
from debrisest.errors import UserError
from debrisest.roles import Part

_LIBRARIES = {"numpy", "scipy"}
_NUMERIC = (OverflowError, FloatingPointError, ZeroDivisionError, RuntimeWarning, LinAlgError)
"""What ordinary code raises of numbers that are far too large or too small."""
_MOST_TOLD = 300


@contextmanager
def about(path: str, part: Part) -> Iterator[None]:
    """Note on whatever is raised within which part of the scenario raised it."""
    try:
        yield
    except Exception as error:
        with_keys = f" with {_keys(part)}" if isinstance(error, _NUMERIC) else ""
        error.add_note(f"{path} ({kind_of(type(part))}){with_keys}")
        raise


def reason(error: Exception) -> str:
    """Return why a run failed, the part first; what nobody foresaw is said to be a mistake."""
    said = str(error) or "no more is known"
    if not _on_purpose(error):
        cause = "a value may be too large or too small; if none is, " * isinstance(error, _NUMERIC)
        said = (
            f"{type(error).__name__}: {said}; {cause}this is a mistake of debrisest or of a "
            "plug-in: please report it"
        )
    return ": ".join([*getattr(error, "__notes__", []), said])


def _keys(part: Part) -> str:
    """Return the keys that the scenario gives a part, as far as they are told in a line."""
    given = part.model_dump(mode="json", include=part.model_fields_set - {"kind"})
    told = ", ".join(f"{key}: {value}" for key, value in given.items())
    return told if len(told) <= _MOST_TOLD else f"{told[:_MOST_TOLD]}..."


def _on_purpose(error: Exception) -> bool:
    """Whether a part raised it, with a sentence, and not a line that no one thought would fail."""
    where = extract_tb(error.__traceback__)[-1]
    by_library = _LIBRARIES & set(Path(where.filename).parts)
    raised = (where.line or "").startswith("raise ") and not by_library
    return raised and type(error) in (ValueError, UserError)
