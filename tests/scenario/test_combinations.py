"""Whatever combination of parts is valid runs, and ends well or in a sentence about its data."""

from pathlib import Path

import pytest

from debrisest.catalog import CATALOG, kind_of
from debrisest.results import store
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.runner.sweep import Machine, bring_up_to_date
from debrisest.scenario.load import LoadedScenario, load_scenario
from debrisest.scenario.resolved import resolved
from debrisest.show.tables.tabulate import tabulate
from tests.worlds import KEYS, World, loaded

SEEDS = range(30)


@pytest.fixture(scope="module")
def valid(tmp_path_factory: pytest.TempPathFactory) -> dict[int, LoadedScenario]:
    """The scenarios that are valid once what is refused of their estimators is left out."""
    folder = tmp_path_factory.mktemp("worlds")
    found = {seed: loaded(folder / f"{seed}.yaml", World(seed).scenario(12)) for seed in SEEDS}
    return {seed: scenario for seed, scenario in found.items() if scenario is not None}


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_valid_ends_well_or_in_a_sentence(
    valid: dict[int, LoadedScenario], seed: int, tmp_path: Path
) -> None:
    if seed not in valid:
        pytest.skip("refused before it runs")
    bring_up_to_date([valid[seed]], tmp_path, Selection(), Machine(quiet=True))
    tabulate(valid[seed], tmp_path, plan(valid[seed], tmp_path, Selection()))
    failed = {why for file in tmp_path.rglob("*.h5") for why in store.read(file).get("failure", [])}
    assert not [why for why in failed if "mistake of debrisest" in why]


def test_every_problem_is_among_what_is_valid(valid: dict[int, LoadedScenario]) -> None:
    estimators = [one for each in valid.values() for one in each.common.estimators.values()]
    found = {kind_of(type(one.problem)) for one in estimators if one.problem is not None}
    assert found >= KEYS.keys() & {kind_of(part) for part in CATALOG["problem"]}


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_stored_of_a_case_is_the_same_case(
    valid: dict[int, LoadedScenario], seed: int, tmp_path: Path
) -> None:
    if seed not in valid:
        pytest.skip("refused before it runs")
    (case,) = valid[seed].cases.values()
    (tmp_path / valid[seed].path.name).write_text(resolved(case))
    again = load_scenario(tmp_path / valid[seed].path.name)
    steps = [plan(one, tmp_path, Selection()) for one in (valid[seed], again)]
    assert [step.key for step in steps[0]] == [step.key for step in steps[1]]
