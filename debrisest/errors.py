"""Errors that are told to a person, without a trace."""

from collections.abc import Iterable

_CONTROLS = {number: f"\\x{number:02x}" for number in (*range(32), *range(127, 160))}
_CONTROLS[ord("\n")], _CONTROLS[ord("\t")] = "\n", "\t"


def printable(text: str) -> str:
    """Return a text with its control characters written out, and with nothing that has no code."""
    return text.translate(_CONTROLS).encode(errors="backslashreplace").decode()


class UserError(Exception):
    """The user's input is wrong: one or more sentences, each complete in itself (exit code 2)."""

    def __init__(self, problems: str | Iterable[str]) -> None:
        told = [problems] if isinstance(problems, str) else problems
        self.problems = [printable(problem) for problem in told]
        super().__init__("\n".join(self.problems))
