"""A small share of what ``scripts/damage.py`` and ``scripts/mutate.py`` do."""

import runpy
from pathlib import Path

import pytest


def test_damage_is_told_and_mended(tmp_path: Path, shipped: Path) -> None:
    script = runpy.run_path(str(shipped.parent / "scripts" / "damage.py"))
    config, out = script["reduced"](tmp_path), tmp_path / "out"
    script["run"]("sweep", config, "--out", out)
    found = script["tally"](config, out, seed=5, count=2, files=1, page=2**15)
    assert {how for _, how in found} == {"all"}, found
    assert found["structure", "all"] == found["structure under a seal", "all"] == 2


@pytest.mark.parametrize("kind", ["yaml", "published", "tracks", "poses", "accepted"])
def test_texts_at_random_are_read_or_refused(kind: str, tmp_path: Path, shipped: Path) -> None:
    script = runpy.run_path(str(shipped.parent / "scripts" / "mutate.py"))
    (tmp_path / "now").mkdir()
    found = script["tally"](kind, 5, 6, tmp_path / "now")
    assert found == {"all": 6}
