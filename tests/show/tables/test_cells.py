"""The cells of the tables: figures, counts, verdicts, and their rendering."""

import csv
import json
import re
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import chi2

from debrisest.errors import UserError
from debrisest.results.assessed import Result
from debrisest.scenario.load import LoadedScenario, load_scenario
from debrisest.show.tables.cells import COLUMNS, cells, unexpected
from debrisest.show.tables.render import render

HEADER = (
    "table,case,estimator,quantity,unit,statistic,window,published,measured,ci_low,ci_high,bound,"
    "runs,failed,diverged,verdict,consistent_low,consistent_high"
)
TIMES = np.arange(60.0)
DEG = np.pi / 180


@pytest.fixture
def scenario(small: Path) -> LoadedScenario:
    return load_scenario(small)


def result(rate: list[float], pitch: list[float], failures: dict[int, str] | None = None) -> Result:
    """Errors that are constant over time, in degrees (per second), one figure per run."""
    constant = {
        "rate": np.abs(rate),
        "rate_1": np.array(rate),
        "pitch": np.array(pitch),
        "recovered_pitch": 2 * np.array(pitch),
    }
    errors = {name: DEG * np.repeat(v[:, None], 60, axis=1) for name, v in constant.items()}
    return Result(errors, TIMES, failures or {}, len(rate))


GOOD = result([1.0, 2.0, 3.0], [0.1, 0.2, 0.3])


def rows_of(scenario: LoadedScenario, **results: Result) -> pd.DataFrame:
    """Return the cells of results given as ``case_estimator``."""
    given = {tuple(name.split("_")): found for name, found in results.items()}
    return cells(scenario, given)


def cell(rows: pd.DataFrame, **wanted: str) -> Any:
    for column, value in wanted.items():
        rows = rows[rows[column] == value]
    assert len(rows) == 1
    return rows.iloc[0]


def test_the_header_is_the_contract(reference: Path) -> None:
    text = (reference / "small" / "tables.csv").read_text()
    assert text.splitlines()[0] == HEADER
    assert text.endswith("\n")
    assert "\r" not in text


def test_figures_are_in_the_unit_of_the_tables(scenario: LoadedScenario) -> None:
    rows = rows_of(scenario, slow_triad=GOOD)
    rate = cell(rows, quantity="rate_1", window="40-60 s")
    assert rate["measured"] == pytest.approx(2.0, rel=1e-6)
    assert (rate["unit"], rate["statistic"]) == ("deg/s", "rmse")
    assert 0.0 < rate["ci_low"] < 2.0 < rate["ci_high"]
    assert (rate["runs"], rate["failed"], rate["diverged"]) == (3, 0, 0)
    assert np.isnan(rate["bound"])


@pytest.mark.parametrize("bound", ["bound", "smoother_bound"])
def test_a_bound_is_the_same_figure_of_the_estimator_that_is_named(small: Path, bound: str) -> None:
    text = small.read_text().replace("\n  wahba:", f"\n  {bound}:")
    if bound != "bound":
        text = text.replace("\n  triad:", f"\n  triad:\n    bound: {bound}")
    small.write_text(text)
    half = result([0.5, 1.0, 1.5], [0.1, 0.1, 0.1])
    rows = cells(load_scenario(small), {("slow", "triad"): GOOD, ("slow", bound): half})
    rate = cell(rows, quantity="rate_1", window="40-60 s", estimator="triad")
    assert (rate["measured"], rate["bound"]) == (pytest.approx(2.0), pytest.approx(1.0))
    alone = cells(load_scenario(small), {("slow", "triad"): GOOD})
    assert alone["bound"].isna().all()


def test_a_bound_that_is_no_estimator_is_told(small: Path) -> None:
    small.write_text(small.read_text().replace("\n  triad:", "\n  triad:\n    bound: smother"))
    with pytest.raises(UserError, match=r"bound: no estimator 'smother'; allowed: triad"):
        load_scenario(small)


def test_a_rule_of_divergence_may_name_its_statistic(small: Path) -> None:
    """Two epochs of 100 deg/s among twenty: RMS 31.6, mean 10 deg/s."""
    peak = result([0.0, 0.0], [0.1, 0.1])
    peak.errors["rate"][1, 40:42] = 100 * DEG
    text = small.read_text().replace("above: 90", "above: 20")
    counts = []
    for statistic in ("rms", "mean"):
        small.write_text(text.replace("above: 20", f"above: 20, statistic: {statistic}"))
        rows = rows_of(load_scenario(small), slow_triad=peak)
        counts.append(cell(rows, quantity="rate_1", window="end")["diverged"])
    assert counts == [1, 0]


def test_an_instant_is_a_window(small: Path) -> None:
    small.write_text(small.read_text().replace("windows: [40-60 s, end]", "windows: [50 s]"))
    found = result([1.0, 2.0, 3.0], [0.1, 0.2, 0.3])
    found.errors["rate_1"][:, 50] = 7 * DEG
    rate = cell(rows_of(load_scenario(small), slow_triad=found), quantity="rate_1", window="50 s")
    assert rate["measured"] == pytest.approx(7.0, rel=1e-6)


def test_a_recovery_and_a_filter_share_the_name_of_their_error(scenario: LoadedScenario) -> None:
    rows = rows_of(scenario, slow_triad=GOOD)
    assert cell(rows, table="1", quantity="pitch")["measured"] == pytest.approx(0.4, rel=1e-6)
    filtered = cell(rows, table="2", quantity="pitch", window="end")
    assert filtered["measured"] == pytest.approx(0.2, rel=1e-6)


def test_a_mean_needs_all_its_cases(scenario: LoadedScenario) -> None:
    assert "mean" not in set(rows_of(scenario, slow_triad=GOOD)["case"])
    other = result([5.0, 7.0], [0.3, 0.5])
    rows = rows_of(scenario, slow_triad=GOOD, fast_triad=other)
    mean = cell(rows, case="mean", quantity="rate_1", window="end")
    assert mean["measured"] == pytest.approx((2 + 6) / 2, rel=1e-6)
    assert mean["runs"] == 5


def test_verdicts_stand_beside_published_values(scenario: LoadedScenario) -> None:
    rows = rows_of(scenario, slow_triad=GOOD, fast_triad=GOOD)
    assert cell(rows, table="1", case="slow")["verdict"] == "reproduced"
    assert cell(rows, table="1", case="slow")["published"] == 0.8
    assert cell(rows, case="fast", quantity="rate_1", window="40-60 s")["verdict"] == "worse"
    assert cell(rows, case="fast", quantity="rate_1", window="end")["verdict"] == "unpublished"


def test_failed_runs_are_counted_and_left_out(scenario: LoadedScenario) -> None:
    broken = result([1.0, np.nan, 3.0], [0.1, np.nan, 0.1], {1: "ValueError: no"})
    rate = cell(rows_of(scenario, fast_triad=broken), quantity="rate_1", window="40-60 s")
    assert (rate["runs"], rate["failed"], rate["diverged"]) == (3, 1, 0)
    assert rate["measured"] == pytest.approx(2.0, rel=1e-6)


def test_diverged_runs_are_counted_and_left_out(scenario: LoadedScenario) -> None:
    """The scenario's limit is 90 deg/s; it speaks of the filter, not of the recovery."""
    lost = result([1.0, 91.0, 89.0], [0.1, 0.2, 0.3])
    rows = rows_of(scenario, slow_triad=lost)
    rate = cell(rows, quantity="rate_1", window="40-60 s")
    assert (rate["failed"], rate["diverged"]) == (0, 1)
    assert rate["measured"] == pytest.approx(45.0, rel=1e-6)
    pitch = cell(rows, table="2", quantity="pitch", window="end")
    assert pitch["measured"] == pytest.approx(0.2, rel=1e-6)
    assert cell(rows, table="1")["diverged"] == 0


def test_a_failed_run_is_not_diverged_as_well(scenario: LoadedScenario) -> None:
    broken = result([np.nan, np.nan, 3.0], [0.1, np.nan, 0.1], {1: "ValueError: no"})
    rate = cell(rows_of(scenario, slow_triad=broken), quantity="rate_1", window="40-60 s")
    assert (rate["failed"], rate["diverged"]) == (1, 1)
    assert rate["measured"] == pytest.approx(3.0, rel=1e-6)


@pytest.mark.parametrize(
    ("rates", "verdict"),
    [([1.0, 1.0, 99.0, 99.0], "worse"), ([1.0, 99.0, 99.0, 99.0], "not reproduced")],
)
def test_a_majority_of_lost_runs_is_a_verdict(
    rates: list[float], verdict: str, scenario: LoadedScenario
) -> None:
    rows = rows_of(scenario, fast_triad=result(rates, [0.1] * 4))
    assert cell(rows, quantity="rate_1", window="40-60 s")["verdict"] == verdict


def test_when_all_diverged_there_is_no_figure(scenario: LoadedScenario) -> None:
    rows = rows_of(scenario, fast_triad=result([99.0, 99.0], [0.1, 0.1]))
    rate = cell(rows, quantity="rate_1", window="40-60 s")
    assert np.isnan([rate["measured"], rate["ci_low"], rate["ci_high"]]).all()
    assert (rate["verdict"], rate["diverged"]) == ("not reproduced", 2)
    line = render(scenario, rows, "csv").splitlines()[2]
    assert line == "2,fast,triad,rate_1,deg/s,rmse,40-60 s,0.001,,,,,2,0,2,not reproduced,,"


# expected verdicts


def said(scenario: LoadedScenario, **results: Result) -> list[str]:
    """What is unexpected in the cells of these results and no others."""
    asked = {tuple(name.split("_")) for name in results}
    rows = rows_of(scenario, **results)
    return unexpected(scenario, rows, lambda *cell: cell in asked)


def test_a_cell_that_is_not_there_is_unexpected(scenario: LoadedScenario) -> None:
    rows = rows_of(scenario, slow_triad=GOOD)
    sentences = unexpected(scenario, rows, lambda case, estimator: estimator == "triad")
    assert "Table 2, case fast, triad, rate_1 (rmse, 40-60 s): no result" in " ".join(sentences)


def test_expected_verdicts_are_silent(scenario: LoadedScenario) -> None:
    assert said(scenario, slow_triad=GOOD, fast_triad=GOOD) == []


def test_an_unexpected_verdict_is_told(scenario: LoadedScenario) -> None:
    bad = result([1.0, 2.0, 3.0], [3.0, 3.0, 3.0])
    assert said(scenario, slow_triad=bad) == [
        "Table 1, case slow, triad, pitch (rmse, 0-60 s): worse, 6 [6, 6] against 0.8, "
        "expected reproduced"
    ]


def test_an_interval_that_meets_the_band_is_enough(scenario: LoadedScenario) -> None:
    """0.8 x 3 = 2.4 lies between the runs, their mean above it."""
    wide = result([1.0] * 3, [0.5, 1.5, 2.5])
    rows = rows_of(scenario, slow_triad=wide)
    pitch = cell(rows, table="1")
    assert pitch["verdict"] == "worse"
    assert pitch["ci_low"] < 2.4
    assert said(scenario, slow_triad=wide) == []


def test_a_cell_may_expect_one_of_several_verdicts(scenario: LoadedScenario) -> None:
    good = result([1.0] * 3, [0.05] * 3)
    rows = rows_of(scenario, slow_triad=GOOD, fast_triad=good, slow_wahba=good, fast_wahba=good)
    assert cell(rows, table="1", case="mean", estimator="wahba")["verdict"] == "better"
    everything = unexpected(scenario, rows, lambda case, estimator: True)
    assert not any("case mean" in sentence for sentence in everything)


def test_the_check_of_the_command_line(small: Path, swept: Path, cli: Callable) -> None:
    ok = cli("table", small, "--out", swept, "--check")
    assert ok.exit_code == 0, ok.stderr
    assert ok.stderr == "0 verdicts differ from the expected ones\n"
    file = small.with_name("small.csv")
    file.write_text(file.read_text().replace("0.8,3,reproduced", "0.8,3,worse"))
    without = cli("table", small, "--out", swept)
    assert (without.exit_code, without.stderr) == (0, "")
    wrong = cli("table", small, "--out", swept, "--check", "--format", "csv")
    assert wrong.exit_code == 1
    lines = wrong.stderr.splitlines()
    assert lines[-1] == "2 verdicts differ from the expected ones"
    assert lines[0].startswith("Table 1, case slow, triad, pitch (rmse, 0-60 s): reproduced, ")
    assert lines[0].endswith("against 0.8, expected worse")
    assert wrong.stdout.startswith(HEADER)


def test_without_results_there_are_no_tables(small: Path, tmp_path: Path, cli: Callable) -> None:
    result = cli("table", small, "--out", tmp_path / "none")
    assert result.stdout == ""
    assert "left out of the tables: small slow: assess triad" in result.stderr
    assert not (tmp_path / "none").exists()


def test_a_selection_of_what_is_shown_leaves_the_file_whole(
    small: Path, swept: Path, reference: Path, cli: Callable
) -> None:
    shown = cli("table", small, "--out", swept, "--case", "slow", "--estimator", "wahba",
                "--format", "csv").stdout  # fmt: skip
    rows = list(csv.DictReader(StringIO(shown)))
    assert {(row["case"], row["estimator"]) for row in rows} == {("slow", "wahba")}
    whole = (reference / "small" / "tables.csv").read_bytes()
    assert (swept / "small" / "tables.csv").read_bytes() == whole


# consistency


def judged(
    nis: list[float], freedom: float = 50.0, rate: list[float] | None = None, spoilt: int = 0
) -> Result:
    """Runs with constant squares per dimension over the epochs, the first ``spoilt`` unknown."""
    found = result(rate or [1.0] * len(nis), [0.1] * len(nis))
    squares, counts = (np.repeat([values], 60, axis=0).T for values in (nis, [freedom] * len(nis)))
    squares[:, :spoilt], counts[:, :spoilt] = np.nan, 0.0
    found.errors.update(nis=squares, nis_dof=counts)
    return found


NIS: dict[str, str] = {"quantity": "nis"}


@pytest.mark.parametrize(
    ("level", "words"), [(1.0, "consistent"), (1.3, "over-confident"), (0.7, "over-cautious")]
)
@pytest.mark.parametrize("statistic", ["mean", "p50", "median"])
def test_a_normalised_square_is_judged_in_words(
    level: float, words: str, statistic: str, small: Path
) -> None:
    """Three runs of 50 degrees at one epoch: 0.78 to 1.24 for the mean, by the chi-square."""
    text = small.read_text()
    small.write_text(text.replace("statistics: [mean]", f"statistics: [{statistic}]"))
    before, title, after = small.read_text().partition("What a filter says")
    small.write_text(before + title + after.replace("[0-60 s]", "[50 s]"))
    row = cell(rows_of(load_scenario(small), slow_triad=judged([level] * 3)), **NIS)
    assert row["verdict"] == words
    assert row["consistent_low"] < 1 < row["consistent_high"]
    if statistic == "mean":
        wanted = [chi2.ppf(share, 150) / 150 for share in (0.025, 0.975)]
        assert row[["consistent_low", "consistent_high"]].tolist() == pytest.approx(wanted, 1e-5)


def test_diverged_runs_do_not_count_in_a_verdict(scenario: LoadedScenario) -> None:
    found = judged([1.0, 1.0, 500.0], rate=[1.0, 1.0, 99.0])
    row = cell(rows_of(scenario, slow_triad=found), **NIS)
    assert (row["verdict"], row["diverged"]) == ("consistent", 1)
    lost = judged([500.0, 500.0], rate=[99.0, 99.0])
    row = cell(rows_of(scenario, slow_triad=lost), **NIS)
    assert (row["verdict"], row["diverged"]) == ("unpublished", 2)
    assert np.isnan([row["consistent_low"], row["consistent_high"]]).all()


def test_independent_epochs_add_up(scenario: LoadedScenario) -> None:
    """The scenario's window of nis is longer than one epoch, and innovations are white."""
    row = cell(rows_of(scenario, slow_triad=judged([1.0])), **NIS)
    low, high = chi2.interval(0.95, 60 * 50)
    assert row["consistent_low"] == pytest.approx(low / 3000, 1e-5)
    assert row["consistent_high"] == pytest.approx(high / 3000, 1e-5)


def test_a_window_without_freedom_makes_no_cell(scenario: LoadedScenario) -> None:
    rows = rows_of(scenario, slow_triad=judged([1.0, 1.0], spoilt=60))
    assert "nis" not in set(rows["quantity"])


def test_other_quantities_have_no_interval(scenario: LoadedScenario) -> None:
    rows = rows_of(scenario, slow_triad=judged([1.0, 1.0]), fast_triad=judged([1.0, 1.0]))
    others = rows[rows["quantity"] != "nis"]
    assert others[["consistent_low", "consistent_high"]].isna().all(axis=None)
    assert not set(others["verdict"]) & {"consistent", "over-confident", "over-cautious"}


@pytest.mark.parametrize("form", ["md", "tex", "rich", "csv", "json"])
def test_the_words_stand_beside_each_estimator(form: str, scenario: LoadedScenario) -> None:
    given = {"slow_triad": judged([1.0] * 3), "slow_wahba": judged([3.0] * 3)}
    text = render(scenario, rows_of(scenario, **given), form)
    if form == "json":
        text = "\n".join(str(list(record.values())) for record in json.loads(text))
    for estimator, words in (("triad", "consistent"), ("wahba", "over-confident")):
        lines = [line for line in text.splitlines() if estimator in line]
        assert any(words in line for line in lines), (estimator, words)


# rendering


@pytest.fixture
def rendered(small: Path, swept: Path, cli: Callable) -> Callable:
    def run(form: str) -> str:
        return str(cli("table", small, "--out", swept, "--format", form).stdout)

    return run


def test_csv_and_json_hold_the_same(rendered: Callable, swept: Path) -> None:
    text = rendered("csv")
    assert text == (swept / "small" / "tables.csv").read_text()
    table = pd.read_csv(StringIO(text), dtype={"table": str, "case": str})
    records = json.loads(rendered("json"))
    assert len(records) == len(table)
    assert list(records[0]) == HEADER.split(",")
    for record, row in zip(records, table.to_dict("records")):
        for key, value in record.items():
            assert row[key] == value or (value is None and np.isnan(row[key])), key


def figures_of(text: str) -> list[str]:
    return sorted(re.findall(r"\d+\.\d+(?:e-\d+)?", text))


@pytest.mark.parametrize("form", ["md", "tex", "rich"])
def test_laid_out_tables_hold_every_figure(form: str, rendered: Callable) -> None:
    table = pd.read_csv(StringIO(rendered("csv")))
    text = rendered(form).replace("\\[", "[").replace("\\]", "]")
    for low, high in zip(table["ci_low"], table["ci_high"]):
        assert f"[{low:.3g}, {high:.3g}]" in text
    shown = figures_of(re.sub(r"\[[^]]*, [^]]*\]", "", text))
    for measured in table["measured"]:
        assert f"{measured:.3g}" in shown or "." not in f"{measured:.3g}"
    published = table.drop_duplicates(["table", "case", "quantity", "window"])["published"]
    digits = [f"{v:.3g}" for v in [*table["measured"], *published.dropna()]]
    assert shown == sorted(digit for digit in digits if "." in digit)


@pytest.mark.parametrize("form", ["md", "tex", "rich"])
def test_laid_out_tables_name_quantity_unit_and_window(form: str, rendered: Callable) -> None:
    plain = rendered(form).replace("\\", "")
    for words in ("rate_1 (deg/s)", "pitch (deg)", "40-60 s", "end", "rmse", "paper", "wahba"):
        assert words in plain
    assert plain.count("nis") >= 1


def test_the_files_beside_are_what_is_printed(rendered: Callable, swept: Path) -> None:
    for form in ("md", "tex"):
        assert (swept / "small" / f"tables.{form}").read_text() == rendered(form)


def test_latex_is_balanced(rendered: Callable) -> None:
    text = rendered("tex")
    for name in ("table", "tabular"):
        assert text.count(f"\\begin{{{name}}}") == text.count(f"\\end{{{name}}}") == 4
    body = re.sub(r"\\[_%&#$]", "", text)
    assert not re.search(r"^[^%\n]*(?<![\\$])_", body, re.M)
    assert body.count("{") == body.count("}")


def test_titles_with_special_characters(small: Path, swept: Path, cli: Callable) -> None:
    small.write_text(
        small.read_text().replace("Errors after the filter", "50 % [bold] of a_b & {c}")
    )
    latex = cli("table", small, "--out", swept, "--format", "tex").stdout
    assert r"50 \% [bold] of a\_b \& \{c\}" in latex


def test_a_title_in_brackets_is_shown(small: Path, swept: Path, cli: Callable) -> None:
    small.write_text(small.read_text().replace("Errors after the filter", "Errors [rms]"))
    assert "Errors [rms]" in cli("table", small, "--out", swept).stdout


def test_json_keeps_the_digits_of_small_figures(scenario: LoadedScenario) -> None:
    rows = rows_of(scenario, slow_triad=result([1.23456e-9] * 3, [0.1] * 3))
    measured = [record["measured"] for record in json.loads(render(scenario, rows, "json"))]
    assert measured[1] == pytest.approx(1.23456e-9, rel=1e-5)


def test_values_of_a_grid_are_columns(small: Path) -> None:
    text = small.read_text().partition("\ncases:")[0].replace("  published: small.csv\n", "")
    grid = (
        "grid:\n  sensors.points.noise_m: [0.01, 0.02]\n  motion.rate_deg_s: [[1, 0, 0], [2, 0, 0]]"
    )
    small.write_text(f"{text.replace('[slow, fast]', '[]')}\n{grid}\n")
    scenario = load_scenario(small)
    nothing = Result({}, np.arange(61.0), {0: "lost"}, 1)
    rows = cells(scenario, {(case, "wahba"): nothing for case in scenario.cases})
    keys = ["sensors.points.noise_m", "motion.rate_deg_s"]
    assert list(rows.columns) == [*COLUMNS, *keys]
    found = rows.groupby("case", sort=False)[keys].first().to_numpy().tolist()
    assert found == [[n, r] for n in (0.01, 0.02) for r in ("[1, 0, 0]", "[2, 0, 0]")]
    assert cells(scenario, {}).columns.to_list() == rows.columns.to_list()
