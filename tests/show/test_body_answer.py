"""What is printed of a body from images."""

import numpy as np
import pytest

from debrisest.show.body_answer import body_answer


@pytest.mark.parametrize(
    ("share", "told"), [(0.7998, "79.9%"), (0.8, "80%"), (0.8649, "86.4%"), (1.0, "100%")]
)
def test_the_share_that_is_seen_is_not_rounded_up_to_the_limit(share: float, told: str) -> None:
    data = {"volume": np.nan, "surface_seen": share, "moment_ratios": np.full(2, np.nan)}
    assert f"seen             {told} of the surface" in body_answer(data)
