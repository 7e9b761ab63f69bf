"""What every estimator of pose and shape demands of its measurements."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.target.surface import FEWEST_POINTS


def require_measurable(
    data: Data, ranges: Literal["measured_range", "landmark_range"] = "measured_range"
) -> None:
    """Raise ValueError, in one sentence, for too few points or for a range that cannot be."""
    cameras, points = data["measured_pixel"].shape[2:4]
    if cameras != 1:
        raise ValueError(f"the pixels are those of {cameras} cameras; one is possible here")
    if points < FEWEST_POINTS:
        raise ValueError(
            f"pose and shape from one camera need at least {FEWEST_POINTS} points, "
            f"{points} were tracked"
        )
    if np.isnan(data["measured_pixel"]).all(axis=(1, 2, 3, 4)).any():
        raise ValueError("no image shows any point")
    wrong = data[ranges] <= 0.0
    if wrong.any():
        _, epoch = divmod(int(wrong.argmax()), wrong.shape[1])
        raise ValueError(
            f"the range at {data['time_s'][epoch]:g} s is zero or negative; a range finder that "
            "saw nothing must give NaN"
        )
