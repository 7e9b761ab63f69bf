"""Observers on orbits of their own."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import kepler, perturbed_orbit
from debrisest.parts.truth.elements import ClassicalElements


class Satellite(ClassicalElements):
    """A satellite that observes; each further one of a scenario is added to the others."""

    knows = extends = ("observer", "observer_position", "observer_velocity")
    kind: Literal["satellite"]
    j2: bool = False
    """The Earth's oblateness."""

    def simulate_named(self, name: str, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return all observers so far, and this one, in Earth-centred inertial axes."""
        start, runs = self.initial_state(), len(draws.runs)
        if self.j2:
            orbit = perturbed_orbit.propagate(*start, clock.times, perturbed_orbit.J2_EARTH)
        else:
            orbit = kepler.propagate(*start, clock.times)
        names = [*data.get("observer", []), name]
        position, velocity = (_beside(data, *pair, runs) for pair in zip(self.extends[1:], orbit))
        return {
            "observer": np.array(names),
            "observer_position": position,
            "observer_velocity": velocity,
        }

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the same for an observer without a name."""
        return self.simulate_named("", data, clock, draws)


def _beside(data: Data, name: str, values: Array, runs: int) -> Array:
    """Return the observers' arrays (run, time, observer, 3) with one more."""
    added = np.broadcast_to(values[:, None], (runs, len(values), 1, 3))
    return np.concatenate([data[name], added], axis=2) if name in data else added
