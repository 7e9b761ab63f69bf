"""The table of coverage in the guide is what its script finds: the cheap part, with other draws."""

import re
import runpy
from pathlib import Path

import pytest
from scipy.stats import binom

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "scenario.md").read_text(encoding="utf-8")
TRIALS = 400


def _told(statistic: str, law: str) -> list[tuple[float, float]]:
    """Both shares of each number of runs, as the guide has them."""
    row = re.search(rf"^\| {statistic} +\| {re.escape(law)} +\|(.*)\|$", GUIDE, re.M)
    assert row is not None
    return [
        (float(before) / 100, float(after) / 100)
        for before, after in re.findall(r"(\d+) → (\d+)", row[1])
    ]


@pytest.mark.parametrize(
    ("statistic", "law", "runs"),
    [
        ("mean", "gamma (4)", 5),
        ("mean", "exponential", 8),
        ("median", "half-normal", 8),
        ("rms", "lognormal (0.6)", 5),
    ],
)
def test_the_table_of_the_guide(statistic: str, law: str, runs: int) -> None:
    script = runpy.run_path(str(ROOT / "scripts" / "interval_coverage.py"))
    found = script["coverage"](statistic, script["LAWS"][law], runs, TRIALS, seed=1)
    told = _told(statistic, law)[script["RUNS"].index(runs)]
    for share, expected in zip(found, told):
        low, high = binom.interval(1 - 1e-5, TRIALS, [expected - 0.03, expected + 0.03])
        assert low[0] <= TRIALS * share <= high[1]
