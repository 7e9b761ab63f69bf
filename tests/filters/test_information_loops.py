"""Compiled gathering of information against the numpy code, whose oracles are in test_bound."""

import numpy as np
import pytest

from debrisest import compiled
from debrisest.filters.bound.information import Information, gather

pytest.importorskip("numba")


@pytest.mark.parametrize(("n", "c", "d"), [(11, 11, 11), (29, 14, 14), (23, 7, 5)])
def test_information_is_gathered_the_same(
    monkeypatch: pytest.MonkeyPatch, n: int, c: int, d: int
) -> None:
    draws = np.random.default_rng(n)
    rows = draws.normal(size=(3, 6, 8, n)) * (draws.random((3, 6, 8, n)) < 0.6)
    rows[:, 2] = 0.0
    residual, moved = draws.normal(size=(3, 6, 8)), draws.normal(size=(3, 6, c, d))
    prior = np.tile(np.diag(np.logspace(-2, 3, n)), (3, 1, 1))
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        held = Information(prior.copy(), np.ones((3, n)))
        found.append((*gather(held, rows, residual, moved), *held))
    for loops, plain in zip(*found):
        np.testing.assert_allclose(loops, plain, rtol=1e-12, atol=1e-12 * np.abs(plain).max())
