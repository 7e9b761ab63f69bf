"""What the README and the guide to measurements print is what the commands print."""

import csv
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from debrisest.show.tables.verdict import Verdict, verdict

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
MEASURED = (ROOT / "docs" / "measured.md").read_text(encoding="utf-8")
NUMBER = r"-?\d+(?:\.\d+)?"


def answer_in(text: str, file: str) -> list[str]:
    """The lines from the first word of the answer to the last, without what indents them."""
    printed = text.partition(f"debrisest estimate {file}\n")[2]
    block = re.search(r"^ *accepted: .*?^ *judged .*?$", printed, re.M | re.S)
    assert block is not None
    return [line.strip() for line in block[0].splitlines()]


@pytest.mark.parametrize(
    ("text", "file"),
    [
        (README, "configs/examples/tracks.csv"),
        (README, "configs/examples/poses.csv"),
        (MEASURED, "tracks.csv"),
    ],
    ids=["tracks", "poses", "guide"],
)
def test_the_answer_is_the_one_that_is_printed(
    text: str, file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cli: Callable
) -> None:
    """The same words, and numbers up to what another machine's rounding may change."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(ROOT / "configs" / "examples" / Path(file).name, tmp_path / file)
    result = cli("estimate", file, "--quiet")
    assert result.exit_code == 0
    told = answer_in(f"debrisest estimate {file}\n{result.output}", file)
    expected = answer_in(text, file)
    bare = [[re.sub(NUMBER, "", line) for line in lines] for lines in (told, expected)]
    assert bare[0] == bare[1]
    for mine, theirs in zip(told, expected):
        numbers = [np.array(re.findall(NUMBER, line), dtype=float) for line in (mine, theirs)]
        np.testing.assert_allclose(*numbers, rtol=2e-3, atol=2e-4, err_msg=mine)


def test_the_published_values_of_the_tables_are_those_of_the_paper() -> None:
    with (ROOT / "configs" / "published" / "biondi2017.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for number in ("1", "2"):
        table = re.search(rf"^Table {number}: .*?\n\n(?=Table)", README, re.M | re.S)
        assert table is not None
        shown = dict(re.findall(r"^ (\d+|mean) +([\d.]+)\*? ", table[0], re.M))
        wanted = {
            row["case"]: row["published"]
            for row in rows
            if row["table"] == number and row["quantity"] == "pitch"
        }
        assert shown == {case: f"{float(value):.3g}" for case, value in wanted.items()}


def test_the_signs_of_the_tables_follow_from_their_figures() -> None:
    """Each verdict, from the figure before it and the published value at the row's begin."""
    factor = 1.6
    signs = {Verdict.REPRODUCED: "=", Verdict.BETTER: "<", Verdict.WORSE: ">"}
    told = 0
    for number in ("1", "2"):
        table = re.search(rf"^Table {number}: .*?\n\n(?=Table)", README, re.M | re.S)
        assert table is not None
        for published, cells in re.findall(r"^ (?:\d+|mean) +([\d.]+)\*? +(.*)$", table[0], re.M):
            for figure, sign in re.findall(r"([\d.]+) ([=<>])", cells):
                assert signs[verdict(float(figure), float(published), factor, 0.0)] == sign
                told += 1
    assert told == 12 * 6


SPEED = (ROOT / "docs" / "speed.md").read_text(encoding="utf-8")


def test_the_time_of_a_sweep_is_that_of_the_table_of_shares() -> None:
    """CPU seconds of all steps on two cores, with at most half as much again for all else."""
    minutes = re.search(r"about (\d+)\s+minutes\s+on\s+two\s+cores", README)
    together = re.search(r"^\|\s+\|\s+together\s.*?\| ([\d.]+) +\|", SPEED, re.M)
    assert minutes is not None and together is not None
    assert 1.0 < 120 * int(minutes[1]) / float(together[1]) < 1.5


def test_the_ratios_of_speed_are_those_of_the_benchmark() -> None:
    told = re.search(
        r"take a (\d+)th of filterpy's time\s+and ([\d.]+) times that of\s+compiled", README
    )
    rows = dict(re.findall(r"^\| (unscented, 14 states.*?) \| .*? \| ([\d.]+) \(", SPEED, re.M))
    peer, compiled = (float(ratio) for ratio in rows.values())
    assert told is not None
    assert told.groups() == (f"{peer:.0f}", f"{1 / compiled:.1f}")
