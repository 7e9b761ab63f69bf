"""Errors that are told to a person, without a trace."""

import difflib
from collections.abc import Iterable

_CONTROLS = {number: f"\\x{number:02x}" for number in (*range(32), *range(127, 160))}
_CONTROLS[ord("\n")], _CONTROLS[ord("\t")] = "\n", "\t"


def printable(text: str) -> str:
    """Return a text with its control characters written out, and with nothing that has no code."""
    return text.translate(_CONTROLS).encode(errors="backslashreplace").decode()


def meant(given: str, known: Iterable[str]) -> str:
    """Return a question after the known name that was probably meant, or nothing."""
    close = difflib.get_close_matches(given, list(known), n=1, cutoff=0.6)
    return f" (did you mean {close[0]}?)" if close else ""


def allowed_names(given: str, allowed: Iterable[str]) -> str:
    """Return the allowed names, and the one that was probably meant."""
    names = list(allowed)
    return f"allowed: {', '.join(names)}{meant(given, names)}"


class UserError(Exception):
    """The user's input is wrong: one or more sentences, each complete in itself (exit code 2)."""

    def __init__(self, problems: str | Iterable[str]) -> None:
        told = [problems] if isinstance(problems, str) else problems
        self.problems = [printable(problem) for problem in told]
        super().__init__("\n".join(self.problems))
