"""Options of the commands that only write what the results tell."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

import debrisest
from debrisest.cli import app


def test_quiet_writes_the_tables_and_tells_what_is_unexpected(
    small: Path, swept: Path, reference: Path, cli: Callable
) -> None:
    (swept / "small" / "tables.md").unlink()
    done = cli("table", small, "--out", swept, "--quiet")
    assert (done.exit_code, done.stdout, done.stderr) == (0, "", "")
    whole = (reference / "small" / "tables.md").read_bytes()
    assert (swept / "small" / "tables.md").read_bytes() == whole
    file = small.with_name("small.csv")
    file.write_text(file.read_text().replace("0.8,3,reproduced", "0.8,3,worse"))
    wrong = cli("table", small, "--out", swept, "--quiet", "--check")
    assert (wrong.exit_code, wrong.stdout) == (1, "")
    assert "expected worse" in wrong.stderr


def test_quiet_draws_and_names_no_file(small: Path, swept: Path, cli: Callable) -> None:
    some = ("--out", swept, "--case", "slow", "--estimator", "wahba", "--quiet")
    done = cli("plot", small, *some)
    assert (done.exit_code, done.stdout, done.stderr) == (0, "", "")
    assert list((swept / "small" / "plots").glob("rates*.png"))


def test_the_version(cli: Callable) -> None:
    assert cli("--version").stdout == f"debrisest {debrisest.__version__}\n"


def test_a_folder_where_tables_should_go_is_told_in_one_sentence(
    small: Path, swept: Path, cli: Callable
) -> None:
    (swept / "small" / "tables.csv").unlink()
    (swept / "small" / "tables.csv").mkdir()
    done = cli("table", small, "--out", swept)
    assert done.exit_code == 2
    assert done.stderr == f"{swept / 'small' / 'tables.csv'}: Is a directory\n"


def test_the_shell_completes_commands_and_options() -> None:
    for asked, told in (
        ({"_DEBRISEST_COMPLETE": "source_bash"}, "_DEBRISEST_COMPLETE=complete_bash"),
        ({"_DEBRISEST_COMPLETE": "complete_bash"} | words("debrisest sw"), "sweep"),
        ({"_DEBRISEST_COMPLETE": "complete_bash"} | words("debrisest sweep --re"), "--report"),
    ):
        done = CliRunner().invoke(app, [], prog_name="debrisest", env=asked)
        assert told in done.stdout


def words(typed: str) -> dict[str, str]:
    return {"COMP_WORDS": typed, "COMP_CWORD": str(len(typed.split()) - 1)}


@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_pipes_and_devices_where_tables_should_go_are_not_read(
    kind: str, small: Path, swept: Path, reference: Path, cli: Callable
) -> None:
    cli("table", small, "--out", reference)
    names = ("tables.csv", "tables.origin.json")
    for path in (swept / "small" / name for name in names):
        path.unlink(missing_ok=True)
        os.mkfifo(path) if kind == "pipe" else path.symlink_to("/dev/full")
    done = cli("table", small, "--out", swept)
    table = swept / "small" / "tables.csv"
    told = f"{table}: this file was not written by debrisest; it is now tables.csv.old\n"
    assert (done.exit_code, done.stderr) == (0, told)
    for name in names:
        assert (swept / "small" / name).read_bytes() == (reference / "small" / name).read_bytes()


def test_many_problems_of_one_kind_are_folded_and_others_are_not(
    small: Path, tmp_path: Path, cli: Callable
) -> None:
    wrong = "".join(
        f"  c{index}: {{sensors: {{points: {{noise_cm: {index}}}}}}}\n" for index in range(300)
    )
    small.write_text(small.read_text() + wrong + "  last: {run: 2}\n")
    done = cli("validate", small)
    first, more, last = done.stderr.splitlines()
    assert done.exit_code == 2
    assert "sensors.points.noise_cm: unknown key" in first and "did you mean runs?" in last
    line = int(first.split(":")[1])
    assert more == f"  and 299 more like this, in lines {line + 1} to {line + 299}"
