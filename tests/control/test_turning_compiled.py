"""The compiled control steps against the numpy code, whose oracles are in the files beside."""

from collections.abc import Callable
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from debrisest import compiled
from debrisest.control.closed_loop import Pointing
from debrisest.control.rigid_spacecraft import scaled, spacecraft
from debrisest.control.robust_term import Reading

pytest.importorskip("numba")


def both_ways(monkeypatch: pytest.MonkeyPatch, fly: Callable[[], Pointing]) -> list[Pointing]:
    flown = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        flown.append(fly())
    return flown


def require_same(fast: Pointing, slow: Pointing, tolerance: float) -> None:
    assert np.isfinite(slow.torque).any()
    for mine, other in zip(fast, slow):
        size = np.nanmax(np.abs(other))
        np.testing.assert_allclose(mine, other, rtol=0.0, atol=tolerance * max(size, 1e-3))


@pytest.mark.parametrize("reading", get_args(Reading))
def test_a_control_section_is_the_same(
    monkeypatch: pytest.MonkeyPatch, fly: Callable[..., Pointing], reading: str
) -> None:
    """Rounding moves a torque whose gains are large: 1e-10 of its largest after 2500 steps."""
    keys = {"reading": reading, "torque_limit": 1e-3 if reading == "conditional" else np.inf}
    require_same(*both_ways(monkeypatch, lambda: fly(75, **keys)), 1e-10)


@pytest.mark.parametrize("rounded", [True, False])
def test_satellites_that_are_not_the_model_turn_the_same(
    monkeypatch: pytest.MonkeyPatch, closed_loop: Callable[..., Pointing], rounded: bool
) -> None:
    loop = closed_loop(75, turning=True, rounded=rounded)
    plant = scaled(loop.plant.inertia, np.array([[[1.1, 0.9, 1.0], [0.8, 1.0, 1.2]]]))
    loop = replace(loop, plant=spacecraft(plant), delivered=np.array([[[0.9, 1, 1], [1, 1.2, 1]]]))
    require_same(*both_ways(monkeypatch, lambda: loop.run(np.zeros((1, 2, 3)))), 1e-10)
