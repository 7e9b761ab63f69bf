"""The documentation site: its tutorial runs, and no page or picture is left out."""

import re
import shlex
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from debrisest.scenario.load import load_scenario
from debrisest.show.plots.kinds import FIGURES

DOCS = Path(__file__).parent.parent / "docs"
_COMMAND = r"(?:^    |^\$ |`(?=debrisest \w+ ))debrisest ([a-z]+)( [^`\n]*)?"
TUTORIAL = (DOCS / "tutorial.md").read_text(encoding="utf-8")


def test_the_tutorial(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, shipped: Path, cli: Callable
) -> None:
    """Every line that one is told to type, in order; what is said of it is looked at."""
    pytest.importorskip("jinja2")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    shutil.copy(shipped / "examples" / "tracks.csv", tmp_path)
    (tmp_path / "mine.yaml").write_text(
        re.findall(r"^```yaml\n(.*?)^```", TUTORIAL, re.M | re.S)[0]
    )
    told = {}
    for line in re.findall(r"^\$ debrisest (.*)$", TUTORIAL, re.M):
        result = cli(*shlex.split(line))
        assert result.exit_code == 0, f"{line}: {result.output}"
        told[line] = result.output
    assert "0 of 7 steps would run" in told["sweep mine.yaml --dry-run"]
    changed = "sensors.camera.noise_m=0.05"
    assert f"results/mine@{changed}" in told[f"sweep mine.yaml --set {changed}"]
    compared = told["compare results/mine --estimator unscented --estimator extended"]
    assert "paired: the same data (2 cells)" in compared
    assert "accepted: torque-free motion explains the data" in told["estimate tracks.csv"]
    again = cli("sweep", "mine.yaml", "--dry-run", "--set", changed).output
    assert "0 of 7 steps would run" in again


def test_every_page_is_in_the_index_and_every_picture_in_the_gallery() -> None:
    index = re.findall(r"^(\w+)$", (DOCS / "index.md").read_text(encoding="utf-8"), re.M)
    pages = {path.stem for path in DOCS.glob("*.md")} - {"index"}
    assert sorted(index) == sorted(pages)
    shown = re.findall(r"\(images/([\w.]+)\)", (DOCS / "gallery.md").read_text(encoding="utf-8"))
    assert sorted(shown) == sorted(path.name for path in (DOCS / "images").iterdir())


def test_the_figures_of_the_gallery_are_those_of_scenarios_and_cases_that_there_are(
    shipped: Path,
) -> None:
    gallery = (DOCS / "gallery.md").read_text(encoding="utf-8")
    told = re.findall(r"`debrisest plot ([\w-]+)(?: --case (\S+))? --figure (\w+)`", gallery)
    assert len(told) == gallery.count("--figure ") - 1
    for name, case, figure in told:
        assert figure in FIGURES
        assert not case or case in load_scenario(shipped / f"{name}.yaml").cases


@pytest.mark.parametrize("page", sorted(path.name for path in DOCS.glob("*.md")))
def test_commands_and_their_options_exist(page: str, cli: Callable) -> None:
    """Of all commands in the pages, whether they can be run here or not."""
    text = (DOCS / page).read_text(encoding="utf-8")
    for command, rest in re.findall(_COMMAND, text, re.M):
        result = cli(command, "--help")
        assert result.exit_code == 0, f"{page}: debrisest {command} is no command"
        missing = [one for one in re.findall(r"--[a-z][a-z-]+", rest) if one not in result.output]
        assert not missing, f"{page}: debrisest {command} has no option {missing}"
