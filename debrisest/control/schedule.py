"""When estimation sections end and control sections end, for all satellites together.

As soon as the target is within a margin of the edge of any satellite's image, or has left it, all
satellites turn, until the slowest is done (Li et al., section V). The next estimation section
starts at the first epoch after that and lasts at least one epoch.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.control import two_stage
from debrisest.control.camera import Camera
from debrisest.control.two_stage import Memory


class State(NamedTuple):
    """Of all satellites in all runs, at an epoch."""

    section: IntArray
    """(run,): 0, 2, ... estimation, 1, 3, ... control."""
    angles: Array
    rate_b: Array
    seen: Array
    """Last pixel in view in this section, as measured; NaN where there is none."""
    memory: Memory

    @property
    def turning(self) -> BoolArray:
        """Runs in a control section."""
        return np.asarray(self.section % 2 == 1)

    def turned(self, after: "State", waiting: Array) -> "State":
        """``after`` where the satellites turn; elsewhere nothing but the angles, ``waiting``."""
        return self._replace(
            angles=_where(self.turning, after.angles, waiting),
            rate_b=_where(self.turning, after.rate_b, self.rate_b),
            memory=_chosen(self.turning, after.memory, self.memory),
        )


def first(pixel: Array, angles: Array) -> State:
    """Return the state at the start: an estimation section, at rest; ``pixel`` is as measured."""
    section = np.zeros(len(pixel), dtype=np.int64)
    return State(section, angles, np.zeros_like(angles), pixel, two_stage.start(pixel, angles))


def scheduled(
    state: State, camera: Camera, pixel: Array, measured: Array, rate_at_rest: Array
) -> State:
    """Return the state after sections that end at this epoch have ended, and others have started.

    ``pixel`` and the angles ``measured`` are those of the epoch; ``rate_at_rest`` is the body rate
    of a satellite whose attitude stood still.
    """
    ends = state.turning & (state.memory.stage == two_stage.DONE).all(-1)
    starts = ~state.turning & camera.is_left(pixel, state.seen)
    keeps = np.isnan(pixel) & ~ends[:, None, None]
    state = state._replace(
        section=state.section + ends + starts, seen=np.where(keeps, state.seen, pixel)
    )
    if not starts.any():
        return state
    fresh = two_stage.start(state.seen, measured)
    return state._replace(
        memory=_chosen(starts, fresh, state.memory),
        rate_b=_where(starts, rate_at_rest, state.rate_b),
    )


def _where(runs: BoolArray, new: Array, old: Array) -> Array:
    return np.where(runs.reshape(-1, *[1] * (new.ndim - 1)), new, old)


def _chosen(runs: BoolArray, new: Memory, old: Memory) -> Memory:
    stage = np.where(runs[:, None], new.stage, old.stage)
    return Memory(stage, *(_where(runs, a, b) for a, b in zip(new[1:], old[1:])))
