"""What the batch is handed: a `MotionModel`, the measurements of runs of one body each."""

from collections.abc import Callable
from typing import NamedTuple

from debrisest.arrays import Array
from debrisest.batch.motion import Motion


class MotionModel(NamedTuple):
    """Runs of a body whose whole motion is estimated at once from all that was measured."""

    times: Array
    """Epochs (time,), s."""
    runs: int
    estimate: Callable[[int], Motion]
    """From the number of a run in the batch to its motion."""
    error_names: tuple[str, ...]
