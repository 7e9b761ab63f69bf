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
def test_heads_are_whole_on_the_terminal(
    count: int, scenario: LoadedScenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "110")
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


def detailed(**columns: object) -> dict:
    of_all = {"published": 1.0, "ci_low": 0.875, "ci_high": 1.125, "bound": 0.8, "measured": 1.2}
    return of_all | {"verdict": "reproduced"} | columns


@pytest.mark.parametrize(("width", "shown"), [(60, False), (80, True), (220, True)])
def test_intervals_are_shown_where_the_terminal_is_wide_enough(
    width: int, shown: bool, scenario: LoadedScenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    names = ["peak_torque", "settling_time"]
    text = render(scenario, table(*(detailed(quantity=name) for name in names)), "rich")
    lines = [line for line in text.splitlines() if line[:5] not in ("Table", "= rep")]
    assert max(map(len, lines)) <= width
    assert (text.count("1.2 [0.875, 1.12] ×1.5 =") == 2) is shown
    assert ("[low, high] 95 % interval" in text) is shown
    assert text.count("1.2") >= 2


def test_a_bound_is_not_told_as_a_multiple_of_itself(scenario: LoadedScenario) -> None:
    text = render(scenario, table(detailed(measured=0.8)), "md")
    assert "0.8 \\[0.875, 1.12\\] =" in text
    assert " ×" not in text.partition("## ")[2]


BELOW, WITHOUT = "×n? the interval lies below", "without ×n: there is no bound"


@pytest.mark.parametrize(
    ("cell", "said", "explained"),
    [
        ({}, "×1.5 =", ["×n times"]),
        ({"bound": 1.0}, "×1.2 =", ["×n times"]),
        ({"bound": 2.0}, "×0.6? =", ["×n times", BELOW]),
        ({"bound": float("nan")}, "] =", []),
        ({"quantity": "nis"}, "] =", []),
        ({"statistic": "share"}, "] =", []),
    ],
)
def test_a_ratio_to_the_bound_is_told_of_errors_and_doubted_below_it(
    cell: dict, said: str, explained: list[str], small: Path, scenario: LoadedScenario
) -> None:
    small.write_text(small.read_text().replace("[mean]", "[mean, share]"))
    wide = small.read_text().replace("[nis]", "[nis, peak_torque]")
    small.write_text(wide)
    cells = table(detailed(**({"quantity": "peak_torque"} | cell)))
    text = render(load_scenario(small), cells, "md").replace("\\", "")
    assert said in text.partition("## ")[2]
    legends = ("×n times", BELOW, WITHOUT)
    assert [legend for legend in legends if legend in text] == explained


def test_figures_without_a_bound_say_so_beside_others(scenario: LoadedScenario) -> None:
    cells = [detailed(quantity="peak_torque"), detailed(quantity="final_angle", bound=None)]
    assert WITHOUT in render(scenario, table(*cells), "md")


@pytest.mark.parametrize("width", [60, 80, 120, 220])
def test_no_figure_is_folded_at_any_width(
    width: int, scenario: LoadedScenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A table that is too wide becomes several, each with the case and the source."""
    monkeypatch.setenv("COLUMNS", str(width))
    cells = [{"quantity": name, "measured": 0.000123 + 1e-6 * i} for i, name in enumerate(WIDE)]
    text = render(scenario, table(*cells), "rich")
    assert max(len(line) for line in text.splitlines() if line[:5] != "Table") <= width
    figures = [f"{0.000123 + 1e-6 * i:.3g}" for i in range(len(WIDE))]
    assert [text.count(figure) for figure in figures] == [1] * len(WIDE)
    assert text.count("source") == text.count("slow   triad") > (width < 120)


def test_latex_has_booktabs_a_label_and_numbers_at_the_right(scenario: LoadedScenario) -> None:
    text = render(scenario, table(detailed(quantity="peak_torque")), "tex")
    assert "\\begin{tabular}{lrr}" in text
    for command in ("\\toprule", "\\midrule", "\\bottomrule", "\\label{tab:small-1}"):
        assert text.count(command) == 1
    assert "\\hline" not in text
    assert r"1.2 [0.875, 1.12] $\times$1.5 =" in text


def test_many_windows_of_few_quantities_are_columns(small: Path) -> None:
    before, title, after = small.read_text().partition("What a filter says")
    after = after.replace("[0-60 s]", "[0-60 s, 10 s, end]")
    small.write_text(before + title + after)
    windows = {"0-60 s": 1.0, "10 s": 2.0, "end": 3.0}
    rows = table(*({"window": name, "measured": value} for name, value in windows.items()))
    text = render(load_scenario(small), rows, "md")
    assert text.count("## Table") == 1
    assert "a truth: nis, mean\n" in text
    assert "| case | source | 0-60 s | 10 s | end |" in text
    assert "| slow | triad | 1 | 2 | 3 |" in text
