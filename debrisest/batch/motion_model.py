"""What the batch is handed: a `MotionModel`, the measurements of runs of one body each."""

from collections.abc import Callable
from typing import NamedTuple

from debrisest.arrays import Array
from debrisest.batch.arc import Arc
from debrisest.batch.motion import Motion

Estimate = Callable[[int, Arc | None, Array | None], Motion]
"""From the number of epochs that count, an arc that may be near, and times, s, to the motion at
these times, or else at the epochs that count."""


class MotionModel(NamedTuple):
    """Runs of a body whose whole motion is estimated at once from all that was measured."""

    times: Array
    """Epochs (time,), s."""
    runs: int
    estimate: Callable[[int], Estimate]
    """Of the number of a run in the batch."""
    error_names: tuple[str, ...]
    frame_is_given: bool
    """Whether body axes are the same whichever epochs count."""
