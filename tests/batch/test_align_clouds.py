"""Rounds that come to rest slowly are left behind by one step to where they lead."""

import numpy as np
import pytest

from debrisest.batch.align_clouds import ahead


@pytest.mark.parametrize("ratio", [0.3, 0.9, 0.986])
def test_steps_that_shrink_by_one_ratio_end_where_they_lead(ratio) -> None:
    end, off = np.random.default_rng(0).normal(size=(2, 8, 3))
    rounds = [end + ratio**k * off for k in range(3)]
    np.testing.assert_allclose(ahead(*rounds), end, atol=1e-9)


def test_what_rests_stays() -> None:
    model = np.random.default_rng(0).normal(size=(8, 3))
    np.testing.assert_array_equal(ahead(model, model, model), model)
