"""Why a run gave no result, in a sentence that says which part of the scenario it is about."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from traceback import extract_tb

from debrisest import arithmetic
from debrisest.catalog import kind_of
from debrisest.errors import UserError
from debrisest.roles import Part

_LIBRARIES = {"numpy", "scipy"}
_MOST_TOLD = 300


@contextmanager
def about(path: str, part: Part) -> Iterator[None]:
    """Note on whatever is raised within which part of the scenario raised it."""
    try:
        yield
    except Exception as error:
        by_values = isinstance(error, (*arithmetic.FAILURES, MemoryError))
        with_keys = f" with {_keys(part)}" if by_values else ""
        error.add_note(f"{path} ({kind_of(type(part))}){with_keys}")
        raise


def reason(error: Exception) -> str:
    """Return why a run failed, the part first; what nobody foresaw is said to be a mistake."""
    said = str(error) or "no more is known"
    report = "this is a mistake of debrisest or of a plug-in: please report it"
    if isinstance(error, arithmetic.FAILURES):
        said = f"{arithmetic.told(error)}; if none is, {report}"
    elif not _on_purpose(error):
        said = f"{type(error).__name__}: {said}; {report}"
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
