"""What explains the signs of a table, and how wide ones are shown."""

import re
from pathlib import Path

import pandas as pd
import pytest

from debrisest.scenario.load import LoadedScenario, load_scenario
from debrisest.show.tables.cells import COLUMNS
from debrisest.show.tables.render import render

SIGNS, LOST, WORDS = "= reproduced", "(n) runs that diverged or failed", "consistent: within"
WIDE = ["total_variation", "aligned_points_remaining", "covariance_trace", "stage_one_time"]
WIDE += ["settling_time", "peak_torque", "final_angle"]


@pytest.fixture
def scenario(small: Path) -> LoadedScenario:
    text = small.read_text()
    small.write_text(text.replace("quantities: [nis]", f"quantities: [nis, {', '.join(WIDE)}]"))
    return load_scenario(small)


def table(*cells: dict) -> pd.DataFrame:
    plain = {"table": "filter", "case": "slow", "estimator": "triad", "statistic": "mean"}
    plain |= {"quantity": "nis", "window": "0-60 s", "measured": 1.0, "runs": 3, "failed": 0}
    plain |= {"unit": "1", "diverged": 0, "published": None, "verdict": "unpublished"}
    return pd.DataFrame([plain | cell for cell in cells], columns=COLUMNS)


@pytest.mark.parametrize("form", ["rich", "md", "tex"])
@pytest.mark.parametrize(
    ("cell", "explained"),
    [
        ({}, []),
        ({"failed": 1}, [LOST]),
        ({"diverged": 2}, [LOST]),
        ({"published": 1.0, "verdict": "reproduced"}, [SIGNS]),
        ({"published": 1.0, "verdict": "worse", "diverged": 1}, [SIGNS, LOST]),
        ({"verdict": "consistent", "failed": 1}, [LOST, WORDS]),
    ],
)
def test_every_sign_is_explained_and_no_other(
    form: str, cell: dict, explained: list[str], scenario: LoadedScenario
) -> None:
    text = render(scenario, table(cell), form)
    assert [legend for legend in (SIGNS, LOST, WORDS) if legend in text] == explained


@pytest.mark.parametrize("form", ["rich", "md", "tex"])
@pytest.mark.parametrize("derived", ["", "the mean of two cases"])
def test_a_published_value_that_is_not_printed_so_is_marked(
    form: str, derived: str, small: Path, scenario: LoadedScenario
) -> None:
    published = small.with_suffix(".csv")
    header, first, *_ = published.read_text().splitlines()
    published.write_text(f"{header},derived\n{first},{derived}\n")
    cell = {"table": "1", "quantity": "pitch", "statistic": "rmse", "published": 0.8}
    text = render(scenario, table(cell | {"verdict": "reproduced"}), form)
    assert ("0.8*" in text.replace("\\", "")) is bool(derived)
    assert (f"* not printed so: {derived}" in text) is bool(derived)


def test_latex_without_signs_explains_none(scenario: LoadedScenario) -> None:
    text = render(scenario, table({}), "tex")
    assert text.startswith("% A small tumbling body\n\n")
    assert "a truth: mean, 0-60 s}\n" in text


def heads_of(text: str) -> list[str]:
    """The heads of a table's columns, which end where the figures below them do."""
    lines = text.splitlines()
    rule = next(index for index, line in enumerate(lines) if "\u2500" in line)
    ends = [match.end() for match in re.finditer(r"\S+", lines[rule + 1])]
    spans = [slice(*edges) for edges in zip([0, *ends], ends)]
    return ["".join(line[span] for line in lines[2:rule]).replace(" ", "") for span in spans]


@pytest.mark.parametrize("count", range(2, len(WIDE) + 1))
def test_heads_are_whole_on_the_terminal(count: int, scenario: LoadedScenario) -> None:
    of_all = {"estimator": "reproduction", "unit": "mN m"}
    text = render(scenario, table(*(of_all | {"quantity": name} for name in WIDE[:count])), "rich")
    assert max(map(len, text.splitlines())) <= 110
    wanted = [f"{name}(mNm)" for name in WIDE[:count]]
    assert heads_of(text) == ["case", "source", *wanted]
    assert sum("(mN m)" in line for line in text.splitlines()) == 1


def test_heads_that_fit_stay_on_one_line(scenario: LoadedScenario) -> None:
    assert "peak_torque (mN m)" in render(
        scenario, table({"quantity": "peak_torque", "unit": "mN m"}, {}), "rich"
    )
