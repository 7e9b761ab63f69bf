"""A small share of what ``scripts/damage.py`` does."""

import runpy
from pathlib import Path


def test_damage_is_told_and_mended(swept: Path, shipped: Path) -> None:
    script = runpy.run_path(str(shipped.parent / "scripts" / "damage.py"))
    found = script["tally"](swept, seed=5, count=2, files=1, page=2**15)
    assert {how for _, how in found} == {"all"}, found
    assert found["structure", "all"] == 2
