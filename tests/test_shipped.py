"""Scenarios that come with the package: by name from anywhere, and written to start from."""

import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from debrisest import shipped as module
from debrisest.errors import UserError
from debrisest.shipped import copy_shipped, scenario_path, shipped_names, shipped_path


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_wheel_has_them_where_they_are_looked_for() -> None:
    package = Path(module.__file__).parent
    pyproject = tomllib.loads((package.parent / "pyproject.toml").read_text(encoding="utf-8"))
    included = pyproject["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    installed, checkout = module._FOLDERS
    assert included == {checkout.name: installed.relative_to(package.parent).as_posix()}


def test_a_name_works_anywhere(here: Path, cli: Callable) -> None:
    done = cli("sweep", "first_steps", "--dry-run")
    assert done.exit_code == 0
    assert "first_steps noise_m=0.01: simulate, runs 0-4: not there yet" in done.stdout


def test_a_file_wins_over_a_shipped_scenario(here: Path) -> None:
    name = Path("first_steps")
    assert scenario_path(name) == shipped_path("first_steps")
    (here / "first_steps").mkdir()
    assert scenario_path(name) == shipped_path("first_steps")
    (here / "first_steps.yaml").touch()
    assert scenario_path(name) == Path("first_steps.yaml")
    (here / "first_steps").rmdir()
    (here / "first_steps").touch()
    assert scenario_path(name) == name


def test_an_unknown_name_is_told_with_the_shipped_ones(here: Path, cli: Callable) -> None:
    done = cli("validate", "biondi2071", "none.yaml")
    assert done.exit_code == 2
    first, second = done.stderr.splitlines()
    assert first.startswith("biondi2071: neither a file nor a shipped scenario")
    assert "did you mean biondi2017?" in first
    assert second.startswith("none.yaml: No such file")


def test_init_writes_the_starter_and_tells_what_runs_it(here: Path, cli: Callable) -> None:
    done = cli("init")
    assert done.exit_code == 0
    assert "debrisest sweep first_steps.yaml" in done.stdout
    written = (here / "first_steps.yaml").read_bytes()
    assert written == shipped_path("first_steps").read_bytes()
    assert cli("validate", "first_steps.yaml").exit_code == 0


@pytest.mark.parametrize("name", shipped_names())
def test_a_copy_is_whole(name: str, here: Path) -> None:
    written = copy_shipped(name, here)
    published = yaml.safe_load(written[0].read_text(encoding="utf-8"))["tables"].get("published")
    assert written[1:] == ([here / published] if published else [])
    for path in written:
        original = shipped_path(name).parent / path.relative_to(here)
        assert path.read_bytes() == original.read_bytes()


def test_init_replaces_nothing_unless_it_is_forced(here: Path, cli: Callable) -> None:
    own = here / "published" / "volpe2017.csv"
    own.parent.mkdir()
    own.write_text("mine")
    done = cli("init", "volpe2017")
    assert done.exit_code == 2
    assert done.stderr.startswith("published/volpe2017.csv: this file is there already")
    assert own.read_text() == "mine"
    assert not (here / "volpe2017.yaml").exists()
    assert cli("init", "volpe2017", "--force").exit_code == 0
    assert own.read_text() != "mine"


def test_no_shipped_scenario_of_that_name(here: Path) -> None:
    with pytest.raises(UserError, match=r"did you mean li2011\?"):
        copy_shipped("li2001", here)
    assert not list(here.iterdir())
