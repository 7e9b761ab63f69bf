"""Runs that fail."""

from collections.abc import Callable
from typing import Any

import pytest


@pytest.fixture
def break_runs() -> Callable:
    """Let a method raise whenever one of the bad runs is among those it is given."""

    def install(
        monkeypatch: pytest.MonkeyPatch, part: type, method: str, where: int, bad: set[int]
    ) -> None:
        original = getattr(part, method)

        def broken(self: Any, *given: Any) -> Any:
            asked = given[where]
            runs = asked.runs if hasattr(asked, "runs") else asked["run"].astype(int).tolist()
            if bad & set(runs):
                raise ArithmeticError("the tank is empty")
            return original(self, *given)

        monkeypatch.setattr(part, method, broken)

    return install
