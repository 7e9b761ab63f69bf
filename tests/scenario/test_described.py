"""What an editor learns from the schema: units, defaults, the words that are allowed."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from debrisest.assessment.statistics import STATISTICS
from debrisest.notebook import schema
from debrisest.scenario.described import _UNITS, described
from debrisest.scenario.load import load_scenario
from debrisest.shipped import SCHEMA, shipped_names, shipped_path
from debrisest.vocabulary import VOCABULARY


@pytest.fixture(scope="module")
def models() -> dict[str, dict]:
    found = schema()
    return {"ScenarioFile": found} | found["$defs"]


def test_every_key_with_a_unit_tells_it(models: dict[str, dict]) -> None:
    """Units as words by hand; a longer ending wins over a shorter one."""
    by_hand = {"noise_m": "m", "rate_deg_s": "deg/s", "duration_s": "s"}
    by_hand |= {"inertia_kg_m2": "kg m^2", "semi_major_axis_km": "km"}
    seen = set()
    for model in models.values():
        for key, told in model["properties"].items():
            if key in by_hand:
                seen.add(key)
                assert f" Unit: {by_hand[key]}." in told["description"]
            if any(key.endswith(end) for end in _UNITS):
                assert " Unit: " in told["description"], key
    assert seen == set(by_hand)


def test_defaults_are_told_and_what_is_described_stays(models: dict[str, dict]) -> None:
    told = models["Table"]["properties"]["count_diverged"]
    assert told["description"] == (
        "Runs that diverged count as well, as far as they are finite. Default: False."
    )
    assert described({"properties": {"a_m_s": {"default": 2.0}}})["properties"]["a_m_s"] == {
        "default": 2.0,
        "description": "Unit: m/s. Default: 2.0.",
    }
    assert described({"properties": {"a": {}}}) == {"properties": {"a": {}}}


def test_quantities_and_statistics_are_listed(models: dict[str, dict]) -> None:
    table = models["Table"]["properties"]
    assert table["statistics"]["items"]["enum"] == list(STATISTICS)
    shown = [name for name, entry in VOCABULARY.items() if entry.table_unit]
    assert table["quantities"]["items"]["enum"] == shown


@pytest.mark.parametrize(
    ("right", "wrong", "meant"), [("[pitch]", "[ptich]", "pitch"), ("[rmse]", "[rsme]", "rmse")]
)
def test_a_slip_in_a_table_is_told_with_what_was_meant(
    right: str, wrong: str, meant: str, small: Path
) -> None:
    from debrisest.errors import UserError

    small.write_text(small.read_text().replace(right, wrong, 1))
    with pytest.raises(UserError, match=rf"did you mean {meant}\?"):
        load_scenario(small)


@pytest.mark.parametrize("name", shipped_names())
def test_every_shipped_scenario_names_the_schema_in_its_first_line(name: str) -> None:
    first = shipped_path(name).read_text(encoding="utf-8").splitlines()[0]
    assert first == f"# yaml-language-server: $schema={SCHEMA}"


def test_init_writes_the_schema_beside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cli: Callable
) -> None:
    monkeypatch.chdir(tmp_path)
    assert "wrote schema.json\n" in cli("init").stdout
    written = (tmp_path / SCHEMA).read_text()
    assert written == cli("schema").stdout
    assert json.loads(written)["properties"]["seed"]
    assert cli("init", "biondi2017").exit_code == 0
