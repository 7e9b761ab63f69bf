"""What parts declare fits together, or is refused before anything runs."""

from pathlib import Path
from typing import Any

import pytest

from debrisest.catalog import CATALOG, kind_of
from debrisest.errors import UserError
from debrisest.roles import SimulationPart
from debrisest.scenario.load import load_scenario

PARTS = [(role, part) for role, parts in CATALOG.items() for part in parts]
SIMULATED = [part for _, part in PARTS if issubclass(part, SimulationPart)]
AFTER = [(role, part) for role, part in PARTS if not issubclass(part, SimulationPart)]
TOLD = {name for part in SIMULATED for name in (*part.knows, *part.measures)}
TRUTH = {name for part in SIMULATED for name in part.truths}

START = "    start: &start\n      kind: first_samples\n      samples: 5\n"
VARIANCE = "      variance: {q_ib: 1e-2, q_bf: 0.1, rate_rad2_s2: 2e-2, moments: 0.02}\n"
FIRST_POINTS = (
    "    start: &start\n      kind: first_points\n"
    "      variance: {attitude_rad2: 1, rate_rad2_s2: 0.1, log_inertia: 0.16}\n"
)
PROBLEM = (
    "    problem: &problem\n      kind: tumbling_attitude\n      integrator: rk4\n"
    "      process_noise: {q_ib: 1e-9, q_bf: 1e-11, rate_rad2_s2: 1e-9, moments: 1e-10}\n"
    "      measurement_noise: 1e-4\n"
)
POINTS = "    problem: &problem {kind: tumbling_points}\n"


@pytest.mark.parametrize("part", SIMULATED, ids=kind_of)
def test_the_three_groups_are_apart(part: Any) -> None:
    groups = (part.truths, part.knows, part.measures)
    assert len({name for group in groups for name in group}) == sum(map(len, groups))
    assert not [name for name in part.knows if name.startswith(("true_", "measured_"))]
    assert not [name for name in (*part.truths, *part.measures) if name.startswith("known_")]


@pytest.mark.parametrize(("role", "part"), AFTER, ids=[kind_of(part) for _, part in AFTER])
def test_nothing_after_the_source_needs_a_truth(role: str, part: Any) -> None:
    recovered = {name for recovery in CATALOG["recovery"] for name in recovery.can_give()}
    guessed = {name for name in TOLD if name.startswith("start_")}
    measured = {name for source in CATALOG["measured"] for name in source.can_give()}
    assert set(part.needs) <= TOLD | recovered | guessed | measured
    assert not set(part.needs) & (TRUTH - TOLD)


def refusals(config: Path, *changes: tuple[str, str]) -> list[str]:
    text = config.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    config.write_text(text)
    with pytest.raises(UserError) as refused:
        load_scenario(config)
    return refused.value.problems


FILTER = "filter: &filter {kind: unscented, alpha: 1, beta: 2, kappa: 0}"


def test_a_start_that_does_not_fit_is_refused_with_one_that_does(small: Path) -> None:
    told = refusals(small, (PROBLEM, POINTS), (FILTER, "filter: &filter {kind: replay}"))
    assert len(told) == 2
    assert "start: tumbling_points needs a first guess of q_if, rate_f, log_inertia" in told[0]
    assert "first_samples does not give" in told[0]
    assert told[0].endswith("a start that fits: first_points")


def test_a_guess_that_nobody_has_is_refused_with_who_has_it(small: Path) -> None:
    told = refusals(small, (START + VARIANCE, "    start: &start {kind: guess}\n"))
    assert "needs a first guess of q_ib, q_bf, rate_b, moments_b, which guess does not" in told[0]
    assert "first_samples" in told[0]


def test_a_filter_of_another_model_is_refused_with_those_that_fit(small: Path) -> None:
    told = refusals(small, (PROBLEM, POINTS), (START + VARIANCE, FIRST_POINTS))
    assert "filter: unscented takes a model, but tumbling_points is a replay model" in told[0]
    assert "filters that fit: replay, efficient; problems that fit unscented" in told[0]


def test_each_track_needs_its_filter(tmp_path: Path, shipped: Path) -> None:
    config, jointly = tmp_path / "li2011.yaml", "filter: &jointly\n      kind: "
    config.write_text((shipped / "li2011.yaml").read_text())
    told = refusals(config, (f"{jointly}joint_association\n", f"{jointly}association\n"))
    assert "association takes a scan model" in told[0] and "joint_association" in told[0]
