"""What every estimator of pose and shape demands of its measurements."""

from debrisest.arrays import Data

FEWEST_POINTS = 4


def require_measurable(data: Data) -> None:
    """Raise ValueError, in one sentence, for too few points or for a range that cannot be."""
    points = data["image_point"].shape[2]
    if points < FEWEST_POINTS:
        raise ValueError(
            f"pose and shape from one camera need at least {FEWEST_POINTS} points, "
            f"{points} were tracked"
        )
    wrong = data["measured_range"] <= 0.0
    if wrong.any():
        _, epoch = divmod(int(wrong.argmax()), wrong.shape[1])
        raise ValueError(
            f"the range at {data['time_s'][epoch]:g} s is zero or negative; a range finder that "
            "saw nothing must give NaN"
        )
