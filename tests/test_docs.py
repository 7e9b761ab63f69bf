"""The guides tell every key, every default, every statistic, every verdict and every dataset."""

import re
import runpy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from debrisest.assessment.statistics import STATISTICS
from debrisest.draws import Stream
from debrisest.runner.cut import RUNS_PER_FILE
from debrisest.runner.stages.pipeline import STAGES
from debrisest.scenario.document import merge, parse
from debrisest.scenario.load import load_scenario
from debrisest.scenario.models import scenario_model
from debrisest.scenario.schema import ScenarioFile
from debrisest.show.tables.cells import COLUMNS
from debrisest.show.tables.verdict import SYMBOLS, Verdict
from debrisest.vocabulary import VOCABULARY, axes_of

DOCS = Path(__file__).parent.parent / "docs"
SCENARIO = (DOCS / "scenario.md").read_text(encoding="utf-8")
FILES = (DOCS / "files.md").read_text(encoding="utf-8")
MEASURED = (DOCS / "measured.md").read_text(encoding="utf-8")
GUIDE = runpy.run_path(str(DOCS.parent / "scripts" / "scenario_guide.py"))
SCHEMA = scenario_model(ScenarioFile).model_json_schema()
MODELS = {"ScenarioFile": SCHEMA} | SCHEMA["$defs"]
EXAMPLES = re.findall(r"^```yaml\n(.*?)^```", SCENARIO, re.M | re.S)


def is_whole(example: str) -> bool:
    return re.search(r"^(title|target):", example, re.M) is not None


def names_in(text: str) -> set[str]:
    """The names between backticks, and the last parts of key paths."""
    quoted = re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S))
    return set(quoted) | {name.rpartition(".")[2] for name in quoted}


def sections(text: str) -> dict[str, str]:
    """What stands below each heading of the second level."""
    parts = re.split(r"^## (.*)\n", text, flags=re.M)
    return dict(zip(parts[1::2], parts[2::2]))


def rows(text: str) -> Iterator[list[str]]:
    """The cells of the rows of all tables whose first cell is one quoted name."""
    for line in text.splitlines():
        found = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("| `") and re.fullmatch(r"`[^`]+`", found[0]):
            yield [found[0].strip("`"), *found[1:]]


def kinds() -> dict[str, dict[str, Any]]:
    found = {}
    for model in SCHEMA["$defs"].values():
        if "kind" in model["properties"]:
            found[model["properties"]["kind"]["const"]] = model
    return found


@pytest.mark.parametrize("model", MODELS)
def test_every_key_is_described_and_told(model: str) -> None:
    keys = {key: one for key, one in MODELS[model]["properties"].items() if key != "kind"}
    bare = [key for key, one in keys.items() if not one.get("description")]
    assert not bare, f"these keys of {model} have no text below them in the code: {bare}"
    missing = sorted(set(keys) - names_in(SCENARIO))
    assert not missing, f"docs/scenario.md has no table for these keys of {model}: {missing}"


@pytest.mark.parametrize("kind", kinds())
def test_every_kind_has_a_section_with_its_keys(kind: str) -> None:
    found = [text for head, text in sections(SCENARIO).items() if f"`{kind}`" in head]
    assert len(found) == 1, f"docs/scenario.md needs one section whose heading has `{kind}`"
    bare = kinds()[kind]["properties"].keys() == {"kind"}
    told = re.findall(r"<!-- keys of (\w+) -->", found[0])
    assert told == ([] if bare else [kind]), f"the section of {kind} needs <!-- keys of {kind} -->"


def test_the_tables_of_keys_are_those_of_the_schema() -> None:
    made = GUIDE["written"](SCENARIO, GUIDE["models"]())
    assert made == SCENARIO, "docs/scenario.md is old; run: python scripts/scenario_guide.py"


@pytest.mark.parametrize(
    ("kind", "row"),
    [
        ("feature_points", "| `missing_share` | from 0, below 1 | `0.0` | Share of "),
        ("feature_points", "| `outages_s` | list of 2 numbers, each from 0, ascending | `[]` | "),
        ("pointing_control", "| `satellites.NAME.angles_deg` | 3 numbers | `[0.0, 0.0, 0.0]` | "),
        ("pointing_control", "| `axes` | `repaired`, `printed` | `repaired` | Local orbital "),
        ("random_rigid_body", "| `count` | 2 integers, each from 3, ascending | required | "),
        ("gravity_gradient", "| `q_ib` | 4 numbers, of norm 1 within 0.001 | `[1.0, 0.0, "),
        ("basis_pursuit", "| `signs.first_pieces` | integer, 1 to 12 | `5` | Pieces of which "),
        ("Table", "| `quantities` | list of a name from the list below | required | "),
        ("ScenarioFile", "| `target` | one part | none | The body; "),
    ],
)
def test_keys_are_told_as_one_would_by_hand(kind: str, row: str) -> None:
    text = f"<!-- keys of {kind} -->\n<!-- end -->"
    assert f"\n{row}" in GUIDE["written"](text, GUIDE["models"]())


def test_every_statistic_and_verdict_is_told_in_a_row() -> None:
    told = {key: cells for key, *cells in rows(SCENARIO)}
    assert not set(STATISTICS) - set(told)
    assert not set(Verdict) - set(told)
    for verdict, symbol in SYMBOLS.items():
        assert told[verdict][0] == symbol


def test_every_quantity_of_the_tables_is_told_with_its_unit() -> None:
    section = SCENARIO.partition("### Quantities")[2].partition("### ")[0]
    told: dict[str, str] = {}
    for line in section.splitlines():
        cells = line.split("|")
        if line.startswith("| `"):
            names = re.findall(r"`(\w+)`", cells[1])
            assert not told.keys() & set(names), f"docs/scenario.md tells twice of {names}"
            told |= dict.fromkeys(names, cells[2].strip())
    wanted = {name: entry.table_unit for name, entry in VOCABULARY.items() if entry.table_unit}
    missing = sorted(set(wanted) - set(told))
    assert not missing, f"docs/scenario.md does not tell these quantities: {missing}"
    assert told == wanted


def test_every_dataset_is_told() -> None:
    told = names_in(FILES) | names_in(SCENARIO)
    assert "`_sigma`" in FILES
    missing = [name for name in VOCABULARY if not {name, name.removesuffix("_sigma")} & told]
    assert not missing, f"neither docs/files.md nor docs/scenario.md tells: {missing}"


def test_axes_and_units_of_datasets_are_the_declared_ones() -> None:
    section = sections(FILES)["Datasets"]
    for name, axes, unit, *_ in rows(section):
        assert name in VOCABULARY, f"docs/files.md tells of {name}, which does not exist"
        declared = axes_of(name, axes.count(",") + 1)
        assert axes == ", ".join(declared), f"docs/files.md: axes of {name}"
        assert unit == VOCABULARY[name].unit, f"docs/files.md: unit of {name}"


def test_files_on_disk_are_told_with_their_attributes(reference: Path) -> None:
    h5py = pytest.importorskip("h5py")
    told = names_in(FILES)
    for stage in STAGES:
        with h5py.File(next(reference.rglob(f"{stage}*.h5"))) as file:
            missing = sorted(set(file.attrs) - told)
        assert not missing, f"docs/files.md does not tell these attributes: {missing}"
    assert not set(COLUMNS) - told
    assert f"{RUNS_PER_FILE} runs to a file" in FILES
    for stream in Stream:
        assert f"{int(stream)} {stream.name.lower().replace('_', ' ')}" in " ".join(FILES.split())


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_are_valid(example: str, tmp_path: Path) -> None:
    """A whole example as it stands, a fragment laid on the first whole one."""
    path = tmp_path / "example.yaml"
    document, problems = parse(example, "docs/scenario.md")
    assert not problems
    if not is_whole(example):
        whole = next(text for text in EXAMPLES if is_whole(text))
        document = merge(parse(whole, "docs/scenario.md")[0], document)
        example = yaml.safe_dump(document.value, sort_keys=False)
    path.write_text(example, encoding="utf-8")
    assert load_scenario(path).cases


@pytest.mark.parametrize("text", [SCENARIO, FILES, MEASURED])
def test_links_between_the_guides_lead_somewhere(text: str) -> None:
    for file, anchor in re.findall(r"\]\(([\w./]*)(?:#([\w-]+))?\)", text):
        target = (DOCS / file).read_text(encoding="utf-8") if file else text
        heads = [head.lower() for head in re.findall(r"^#+ (.*)$", target, re.M)]
        anchors = {re.sub(r"[^\w -]", "", head).replace(" ", "-") for head in heads}
        assert not anchor or anchor in anchors, f"{file}#{anchor}"


def test_the_first_steps_comment_every_top_level_key(shipped: Path) -> None:
    text = (shipped / "first_steps.yaml").read_text(encoding="utf-8")
    assert load_scenario(shipped / "first_steps.yaml").cases
    undocumented = [
        line
        for line, before in zip(text.splitlines()[1:], text.splitlines())
        if re.match(r"[a-z_]+:", line) and "#" not in line + before
    ]
    assert undocumented in ([], ["tables:"])
