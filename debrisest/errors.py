"""Errors that are told to a person, without a trace."""

from collections.abc import Iterable


class UserError(Exception):
    """The user's input is wrong: one or more sentences, each complete in itself (exit code 2)."""

    def __init__(self, problems: str | Iterable[str]) -> None:
        self.problems = [problems] if isinstance(problems, str) else list(problems)
        super().__init__("\n".join(self.problems))
