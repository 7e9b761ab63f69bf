"""Each row of docs/errata.md has evidence: a test that exists, a shipped run, or a derivation."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parent.parent.parent
PAGE = (ROOT / "docs" / "errata.md").read_text(encoding="utf-8")
TESTS = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py"))
SCENARIOS = {"Biondi": "biondi2017", "Pesce": "pesce2017", "Li": "li2011", "Volpe": "volpe2017"}
FEWEST_WORDS = 5
"""Of a derivation; fewer are a claim."""


def rows() -> Iterator[tuple[str, str, list[str]]]:
    """Yield paper, place and the other cells of each erratum."""
    for section in PAGE.split("\n## ")[1:]:
        for line in section.splitlines():
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            if cells and cells[0] not in ("equation", "place") and set(cells[0]) != {"-"}:
                yield re.split(r"\W", section)[0], cells[0], cells[1:]


ROWS = list(rows())


@pytest.mark.parametrize(("paper", "place", "cells"), ROWS, ids=[f"{p}-{e}" for p, e, _ in ROWS])
def test_an_erratum_has_its_evidence(paper: str, place: str, cells: list[str]) -> None:
    assert len(cells) == 3, "printed, right, evidence"
    text = " ".join(cells)
    named = [*re.findall(r"`(test_\w+)`", text), *re.findall(r"`(tests/[\w/.*]+)`", text)]
    for name in named:
        there = list(ROOT.glob(name)) if "/" in name else f"def {name}(" in TESTS
        assert there, f"{paper} {place}: {name} does not exist"
    scenario = yaml.safe_load((ROOT / "configs" / f"{SCENARIOS[paper]}.yaml").read_text())
    runs = {*scenario["estimators"], *map(str, scenario["cases"])}
    shown = runs & set(re.findall(r"`([\w-]+)`", text))
    assert named or shown or len(cells[2].split()) >= FEWEST_WORDS, f"{paper} {place}: no evidence"
