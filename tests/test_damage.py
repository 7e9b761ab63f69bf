"""A small share of what ``damage.py``, ``mutate.py`` and ``extreme.py`` of ``scripts/`` do."""

import random
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


def test_extreme_values_are_refused_or_run_through_all_stages(
    tmp_path: Path, shipped: Path
) -> None:
    script = runpy.run_path(str(shipped.parent / "scripts" / "extreme.py"))
    every = list(script["variants"](2, set(), tmp_path))
    random.Random(3).shuffle(every)
    wrong = {said: script["outcome"](scenario, tmp_path)[1] for said, scenario in every[:8]}
    assert not {said: what for said, what in wrong.items() if what}
