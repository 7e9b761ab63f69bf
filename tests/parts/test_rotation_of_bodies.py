"""Bodies that differ from run to run turn as each of them does alone."""

import numpy as np
import pytest

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.parts.truth.gravity_gradient import GravityGradient
from debrisest.parts.truth.torque_free import TorqueFree

CLOCK = Clock(np.arange(0.0, 60.0, 5.0))
BODIES = np.stack([np.diag([1.0, 2.0, 2.5]), np.diag([3.0, 2.0, 4.0]), np.diag([1.0, 2.0, 2.5])])
ORBIT = {
    "orbit_position": np.tile([7e6, 0.0, 0.0], (3, len(CLOCK.times), 1)),
    "orbit_velocity": np.tile([0.0, 7.5e3, 0.0], (3, len(CLOCK.times), 1)),
}


@pytest.mark.parametrize("kind", [TorqueFree, GravityGradient])
def test_each_body_turns_as_it_does_alone(kind: type) -> None:
    motion = kind(
        kind=kind.model_fields["kind"].annotation.__args__[0], rate_deg_s=[1.0, 2.0, -3.0]
    )
    data = {"true_inertia_b": BODIES, **ORBIT}
    together = motion.simulate(data, CLOCK, Draws(1, "x", [0, 1, 2]))
    for run in range(3):
        own = {name: value[run : run + 1] for name, value in data.items()}
        alone = motion.simulate(own, CLOCK, Draws(1, "x", [run]))
        for name in ("true_q_ib", "true_rate_b"):
            assert (together[name][run] == alone[name][0]).all()
    assert np.abs(together["true_rate_b"][0, -1] - together["true_rate_b"][1, -1]).max() > 1e-4
