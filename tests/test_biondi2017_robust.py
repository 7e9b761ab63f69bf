"""The spoilt points are those of the published experiment, but for what is spoilt."""

from pathlib import Path

from debrisest.scenario.load import load_scenario


def test_the_clean_case_is_the_first_of_the_paper(shipped: Path) -> None:
    paper = load_scenario(shipped / "biondi2017.yaml").cases["1"].scenario
    cases = load_scenario(shipped / "biondi2017-robust.yaml").cases
    assert cases["clean"].scenario.simulation == paper.simulation
    for name in ("matches-5", "matches-20", "biased"):
        spoilt = cases[name].scenario.simulation
        assert {k for k, part in spoilt.items() if part != paper.simulation[k]} == {
            "sensors.points"
        }


def test_the_gap_is_in_the_motion_of_the_sixth_case(shipped: Path) -> None:
    paper = load_scenario(shipped / "biondi2017.yaml").cases["6"].scenario
    gap = load_scenario(shipped / "biondi2017-robust.yaml").cases["gap"].scenario
    assert gap.simulation["motion"] == paper.simulation["motion"]
    assert len(gap.simulation["target"].points) == 6
