"""The target whose features differ from run to run."""

from collections.abc import Callable

import numpy as np
import pytest
from pydantic import ValidationError

from debrisest.parts.truth.random_points import RandomPoints


def test_points_fill_the_box_evenly(simulated: Callable) -> None:
    points = simulated(runs=400, duration=2.0)["true_point_b"].reshape(-1, 3)
    assert np.abs(points).max() < 1.5
    share = 1.5 / np.sqrt(3 * len(points))
    assert np.abs(points.mean(0)).max() < 5 * share
    assert points.std(0) == pytest.approx([1.5 / np.sqrt(3)] * 3, rel=0.08)


def test_a_normal_leads_out_of_the_box_on_the_shortest_way(simulated: Callable) -> None:
    data = simulated(runs=50, duration=2.0)
    points, normals = data["true_point_b"], data["true_normal_b"]
    ways = np.concatenate([np.eye(3), -np.eye(3)])
    length = 1.5 - points @ ways.T
    assert np.array_equal(normals, ways[length.argmin(-1)])
    assert (normals.reshape(-1, 3).min(0) == -1).all() and (normals.max((0, 1)) == 1).all()


def test_a_run_does_not_depend_on_its_companions(simulated: Callable) -> None:
    together, alone = simulated(runs=4), simulated(runs=1, first=2)
    assert np.array_equal(together["true_point_b"][2], alone["true_point_b"][0])


def test_the_inertia_has_the_ratios(simulated: Callable) -> None:
    data = simulated(runs=2)
    x, y, z = np.diagonal(data["true_inertia_b"][1])
    assert np.log([x / y, y / z]) == pytest.approx([-0.186, -0.0797], rel=1e-12)
    assert data["true_inertia_ratio"].tolist() == [[-0.186, -0.0797]] * 2
    assert data["feature"].tolist() == ["p1", "p2", "p3", "p4", "p5"]


def test_an_impossible_body_is_refused() -> None:
    with pytest.raises(ValidationError, match="triangle inequality"):
        RandomPoints(kind="random_points", count=5, half_size_m=1.0, inertia_ratios=[1.0, 1.0])
