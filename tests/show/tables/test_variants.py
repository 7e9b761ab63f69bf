"""Results of changed scenarios beside each other, and tables that tell where they come from."""

import json
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

SLOW = ("--case", "slow", "--estimator", "wahba")


def test_a_variant_has_a_folder_of_its_own(small: Path, swept: Path, sweep, cli) -> None:
    before = (swept / "small" / "tables.csv").read_bytes()
    changed = ("--set", "estimators.wahba.filter.redraw=false", "--variant", "drawn-once")
    assert sweep(small, swept, *SLOW, *changed).exit_code == 0
    assert (swept / "small" / "tables.csv").read_bytes() == before
    own = pd.read_csv(swept / "small@drawn-once" / "tables.csv")
    assert set(own["case"]) == {"slow"}
    shown = cli("table", small, "--out", swept, *SLOW, *changed, "--format", "csv").stdout
    plain = cli("table", small, "--out", swept, *SLOW, "--format", "csv").stdout
    assert shown != plain and len(shown.splitlines()) > 1 and len(plain.splitlines()) > 1
    compared = cli("compare", swept / "small", swept / "small@drawn-once").stdout
    assert "estimators.wahba.filter.redraw: True -> False" in compared
    assert "paired: the same data" in compared


def test_settings_without_a_name_replace_nothing(small: Path, swept: Path, sweep, cli) -> None:
    before = (swept / "small" / "tables.csv").read_bytes()
    changed = ("--set", "seed=8", "--set", "estimators.wahba.filter.redraw=false")
    name = "estimators.wahba.filter.redraw=false,seed=8"
    done = sweep(small, swept, *SLOW, *changed)
    assert done.exit_code == 0
    assert f"these results go to {swept / f'small@{name}'}; table without --set" in done.stderr
    assert (swept / "small" / "tables.csv").read_bytes() == before
    turned = sweep(small, swept, *SLOW, *changed[2:], *changed[:2], "--dry-run").stdout
    assert turned.startswith("0 of ")
    plain, derived, named = (
        cli("table", small, "--out", swept, *SLOW, *options, "--format", "csv")
        for options in ((), changed, (*changed, "--variant", name))
    )
    assert f"there are variants too: {name}; show one with" in plain.stderr
    assert derived.stderr == named.stderr
    assert derived.stderr.endswith(f"these tables are of {swept / f'small@{name}'}\n")
    assert len(plain.stdout.splitlines()) == len(derived.stdout.splitlines()) > 1
    assert plain.stdout != derived.stdout == named.stdout


@pytest.mark.parametrize("command", ["simulate", "recover", "filter"])
def test_every_command_has_the_same_folder(
    command: str, small: Path, tmp_path: Path, cli: Callable
) -> None:
    asked = ("--out", tmp_path, *SLOW, "--set", "seed=8")
    assert cli(command, small, *asked, "--jobs", 1, "--runs", 1, "--keep", "all").exit_code == 0
    assert [path.name for path in tmp_path.glob("small*/")] == ["small@seed=8"]
    assert "1 runs there" in cli("status", small, *asked).stdout


def test_the_same_settings_give_the_same_bytes_under_another_name(
    small: Path, swept: Path, sweep, same_data, data_of
) -> None:
    assert sweep(small, swept, *SLOW, "--variant", "twin").exit_code == 0
    name = "slow/assess-wahba.000000.h5"
    assert same_data(data_of(swept / "small")[name], data_of(swept / "small@twin")[name])


def test_a_name_that_no_folder_should_have_is_told(small: Path, tmp_path: Path, cli) -> None:
    done = cli("sweep", small, "--out", tmp_path / "out", "--variant", "../up")
    assert done.exit_code == 2
    assert done.stderr.startswith("--variant ../up: a name has letters, digits, ")
    assert not (tmp_path / "out").exists()


def test_tables_tell_where_they_come_from(swept: Path) -> None:
    told = json.loads((swept / "small" / "tables.origin.json").read_text())
    assert told["settings"]["seed"] == 7
    assert told["settings"]["runs"] == 3
    assert len(told["commit"]) == len(told["software"]) == 1
    assert len(told["computed"]) == 2


def test_tables_that_replace_others_are_told(
    small: Path, swept: Path, sweep: Callable, cli: Callable, rewrite: Callable
) -> None:
    assert cli("table", small, "--out", swept).stderr == ""
    fewer = cli("table", small, "--out", swept, "--runs", 2).stderr
    assert "these tables replace others (runs was 3, is 2); --variant NAME keeps both" in fewer
    assert "replace" in cli("table", small, "--out", swept).stderr
    text = small.read_text()
    done = sweep(rewrite(small, "sensors.points.noise_m=0.02"), swept, *SLOW)
    assert "sensors.points.noise_m was 0.01, is 0.02" in done.stderr
    small.write_text(text)
    for odd in ("[]", "[" * 99999, '{"settings": 3}', "\0"):
        (swept / "small" / "tables.origin.json").write_text(odd)
        assert "replace" not in cli("table", small, "--out", swept).stderr


def test_a_variant_that_is_not_there_is_told_with_the_command_that_makes_it(
    small: Path, swept: Path, cli: Callable
) -> None:
    for variant in ((), ("--variant", "mine")):
        asked = (small, "--set", "seed=9", *variant, "--out", swept)
        words = " ".join(map(str, asked))
        name = "small@mine" if variant else "small@seed=9"
        told = cli("table", *asked).stderr
        assert f"{swept / name}: there is no such variant; run: debrisest sweep {words}" in told
        assert cli("report", *asked).stderr.endswith(f"run: debrisest sweep {words}\n")
