"""Cases that differ in one number are a curve, whether a grid made them or not."""

from collections.abc import Callable
from pathlib import Path

import pytest

from debrisest.scenario.curves import Curve, curves
from debrisest.scenario.load import load_scenario

NOISE = "sensors.points.noise_m"


@pytest.fixture
def of_cases(small: Path) -> Callable[[str], list[Curve]]:
    """The curves of the small scenario with other cases."""
    text = small.read_text().partition("\ncases:")[0].replace("  published: small.csv\n", "")

    def found(cases: str) -> list[Curve]:
        small.write_text(f"{text.replace('[slow, fast]', '[]')}\n{cases}\n")
        return curves(load_scenario(small).cases)

    return found


def test_points_of_a_grid_are_a_curve_for_each_value_of_the_other_key(of_cases) -> None:
    grid = f"grid: {{{NOISE}: [0.03, 0.01, 0.02], sensors.points.depth_noise_factor: [1, 2]}}"
    one, other = of_cases(grid)
    assert one.key == other.key == NOISE
    assert list(one.values.values()) == list(other.values.values()) == [0.01, 0.02, 0.03]
    assert all(name.endswith("factor=1") for name in one.values)
    assert all(name.endswith("factor=2") for name in other.values)


def test_cases_that_differ_in_more_than_a_number_are_on_no_curve(of_cases) -> None:
    (found,) = of_cases(
        "cases:\n  low: {sensors: {points: {noise_m: 0.01}}}\n"
        "  middle: {runs: 2, sensors: {points: {noise_m: 0.02}}}\n"
        "  again: {sensors: {points: {noise_m: 0.02}}}\n"
        "  high: {sensors: {points: {noise_m: 0.04}}}\n"
        "  slow: {motion: {rate_deg_s: [0, 0, 1]}, sensors: {points: {noise_m: 0.08}}}"
    )
    assert found == (NOISE, {"low": 0.01, "middle": 0.02, "high": 0.04})


def test_two_points_are_no_curve(of_cases) -> None:
    assert of_cases(f"grid: {{{NOISE}: [0.01, 0.02]}}") == []
