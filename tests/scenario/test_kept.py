"""Covariances are kept where the tables need them, or the scenario is refused."""

from pathlib import Path
from typing import Any

import pytest

from debrisest.errors import UserError
from debrisest.scenario.load import load_scenario

FILTER = "filter: &filter {kind: unscented"
CASES = "  slow: {motion: {rate_deg_s: [3.0, 2.0, -1.0]}}\n  fast: {}"


def changed(config: Path, *pairs: tuple[str, str]) -> list[str]:
    """The problems of a scenario in which texts were replaced."""
    text = config.read_text()
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    config.write_text(text)
    try:
        load_scenario(config)
    except UserError as error:
        return [problem.removeprefix(str(config)) for problem in error.problems]
    return []


def keeping(times: str) -> tuple[str, str]:
    return FILTER, f"{FILTER}, keep_s: {times}"


def showing(quantity: str, windows: str, more: str = "") -> tuple[str, str]:
    shown = f"quantities: [nis]\n      statistics: [mean]\n      windows: [0-60 s]{more}"
    return "quantities: [nis]\n      statistics: [mean]\n      windows: [0-60 s]", shown.replace(
        "nis", quantity
    ).replace("0-60 s", windows)


def test_times_up_to_the_end_can_be_kept(small: Path) -> None:
    assert changed(small, keeping("[0, 30, 59.4, 60]")) == []


def test_times_beyond_the_end_are_refused_with_their_line(small: Path) -> None:
    found = changed(small, keeping("[30, 60.5, 900]"))
    line = small.read_text()[: small.read_text().index("keep_s")].count("\n") + 1
    assert [problem.split(": ", 1)[0].split(":")[1] for problem in found] == [str(line)] * 2
    for name, problem in zip(("triad", "wahba"), found):
        assert problem.endswith(
            f"estimators.{name}.filter.keep_s: the scenario lasts 60 s; "
            "no covariance can be kept at 60.5, 900 s"
        )


def test_each_case_has_an_end_of_its_own(small: Path) -> None:
    short = CASES.replace("fast: {}", "fast: {duration_s: 70}")
    assert len(changed(small, keeping("[65]"), (CASES, short))) == 2
    assert "lasts 60 s" in changed(small)[0]


def test_an_estimator_is_asked_in_its_own_cases_only(small: Path) -> None:
    long = CASES.replace("fast: {}", "fast: {duration_s: 70}")
    last = "    filter: *filter\n"
    found = changed(
        small,
        keeping("[65]"),
        (CASES, long),
        ("kappa: 0}\n", "kappa: 0}\n    cases: [fast]\n"),
        (last, f"{last}    cases: [fast]\n"),
    )
    assert found == []


def test_an_override_is_told_as_such(small: Path, cli: Any) -> None:
    told = cli("validate", small, "--set", "estimators.triad.filter.keep_s=[99]")
    assert told.exit_code == 2
    assert told.stderr.startswith("--set estimators.triad.filter.keep_s=[99]: ")
    assert "no covariance can be kept at 99 s" in told.stderr


@pytest.mark.parametrize("quantity", ["nees", "w"])
@pytest.mark.parametrize(
    ("kept", "windows", "told"),
    [
        ("[]", "end", []),
        ("[]", "59 s", []),
        ("[20]", "20 s, end", []),
        ("[20]", "10-21 s", []),
        ("[20]", "20 s, 30 s", ["1: no estimator keeps its covariance at 30 s"]),
        ("[20]", "start, 10-20 s", ["0: no", "1: no estimator keeps its covariance at 10-20 s"]),
    ],
)
def test_a_table_of_what_nobody_keeps_is_refused(
    quantity: str, kept: str, windows: str, told: list[str], small: Path
) -> None:
    found = changed(small, keeping(kept), showing(quantity, windows))
    assert len(found) == len(told)
    for words, problem in zip(told, found):
        assert f"tables.layout.2.windows.{words}" in problem
        assert f"which {quantity} needs" in problem


def test_other_tables_need_no_covariance(small: Path) -> None:
    assert changed(small, showing("nis", "20 s")) == []


def test_one_filter_that_keeps_it_is_enough(small: Path) -> None:
    last = "    filter: *filter\n"
    kept = "    filter: {kind: unscented, keep_s: [20]}\n    cases: [slow]\n"
    changes = (last, kept), showing("nees", "20 s")
    assert changed(small, *changes) == []
    of_the_other = "\n      cases: [fast]"
    text = small.read_text()
    small.write_text(text.replace("windows: [20 s]", f"windows: [20 s]{of_the_other}"))
    assert len(changed(small)) == 1
    small.write_text(small.read_text().replace("cases: [fast]", "cases: [mean]"))
    assert changed(small) == []
