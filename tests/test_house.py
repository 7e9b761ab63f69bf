"""What guides say of the house is true of it: files, folders and commands."""

import re
import tomllib
from pathlib import Path

import pytest
import typer
import yaml

from debrisest.cli import app

ROOT = Path(__file__).parent.parent
GUIDES = [ROOT / "CONTRIBUTING.md", ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
CODE = [path for top in ("debrisest", "tests", "scripts") for path in (ROOT / top).rglob("*.py")]
OF_USERS = {"my.py"}


@pytest.mark.parametrize("guide", GUIDES, ids=lambda guide: guide.name)
def test_every_file_of_code_that_a_guide_names_exists(guide: Path) -> None:
    named = set(re.findall(r"[a-z0-9_/]+\.py\b", guide.read_text(encoding="utf-8"))) - OF_USERS
    there = [f"/{path.relative_to(ROOT)}" for path in CODE]
    missing = [name for name in named if not any(p.endswith(f"/{name.strip('/')}") for p in there)]
    assert not missing, f"{guide.name} names files that do not exist: {sorted(missing)}"


def test_every_folder_and_file_at_the_top_is_in_the_table() -> None:
    table = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("## Add")[0]
    told = set(re.findall(r"[a-z_]+(?:/|\.py)", table))
    top = (ROOT / "debrisest").iterdir()
    there = {f"{path.name}/" if path.is_dir() else path.name for path in top}
    there = {name for name in there if name.endswith(("/", ".py")) and not name.startswith("__")}
    assert not there - told, "CONTRIBUTING.md does not say what these hold"


def test_every_command_is_in_the_table() -> None:
    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    table = (ROOT / "README.md").read_text(encoding="utf-8")
    missing = [name for name in commands if f"| `debrisest {name}" not in table]
    assert not missing, f"README.md has no row for these commands: {missing}"


def test_who_cites_it_cites_this_version() -> None:
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert (cited["title"], cited["version"], cited["license"]) == (
        *(project[key] for key in ("name", "version", "license")),
    )
    sources = " ".join(path.read_text("utf-8") for path in (ROOT / "configs").glob("*.yaml"))
    told = [paper["doi"] for paper in cited["references"] if "doi" in paper]
    assert all(doi in sources for doi in told)


def test_the_checks_sweep_every_case_of_every_scenario_and_the_workflow_reproduces_them() -> None:
    checks = (ROOT / "scripts" / "check.sh").read_text(encoding="utf-8").replace("\\\n", " ")
    sweeps = re.findall(r"\bsweep (?:\$.*?\)|[\w. -]*?yaml) +--runs .*", checks)
    named = {name for line in sweeps for name in re.findall(r"([\w-]+)\.yaml", line)}
    (left_out,) = re.findall(r"\$\(ls \*\.yaml \| grep -Ev '(.*)'\)", "".join(sweeps))
    others = [
        path.stem for path in (ROOT / "configs").glob("*.yaml") if re.search(left_out, path.stem)
    ]
    assert set(others) - named == {"pesce2017-images"}
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "tables.yml").read_text("utf-8"))
    steps = workflow["jobs"]["reproduce"]["steps"]
    assert any("scripts/reproduce.py" in step.get("run", "") for step in steps)
