"""Satellites and debris as in the paper's Table 1, and a target that stands still."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

from debrisest.arrays import Array
from debrisest.attitude import euler
from debrisest.control import two_stage
from debrisest.control.camera import Camera
from debrisest.control.closed_loop import ClosedLoop, Pointing
from debrisest.control.rigid_spacecraft import spacecraft
from debrisest.control.track import Track, seen_from
from debrisest.control.two_stage import Controller
from debrisest.dynamics import kepler
from debrisest.sensors import pinhole

GRAM_CM2 = 1e-7
INERTIA = GRAM_CM2 * np.array(
    [[10662.54, -40.20, 73.65], [-40.20, 10415.43, 48.15], [73.65, 48.15, 9618.74]]
)
HALF = np.array([240.0, 180.0])
SUBSTEPS = 50


@pytest.fixture(scope="session")
def inertia() -> Array:
    return INERTIA


def table_1(duration: float) -> list[Array]:
    """Debris (run, time, 3) and satellites (run, time, 2, 3), positions and velocities."""
    times, deg = np.arange(duration), np.radians
    start = kepler.state_from_elements(7.493e6, 0.1, deg(20), deg(35), deg(70), deg(8))
    debris = kepler.propagate(*start, times)
    node = deg([10.0, 7.0])
    start = kepler.state_from_elements(7.5e6, 0.1, deg(30), node, deg(90), deg(8))
    satellites = kepler.propagate(*start, times)
    return [debris[0][None], debris[1][None], *(x.swapaxes(0, 1)[None] for x in satellites)]


@pytest.fixture(scope="session")
def track() -> Callable[..., Track]:
    return lambda duration=90, axes="repaired": seen_from(*table_1(duration), axes)


@pytest.fixture(scope="session")
def closed_loop(track: Callable[..., Track]) -> Callable[..., ClosedLoop]:
    """The paper's loop, with 5 % errors; keys of the controller can be changed."""

    def build(
        duration=90, margin=2.5, rounded=True, turning=False, frozen="local", **keys
    ) -> ClosedLoop:
        controller = Controller(spacecraft(INERTIA), np.array([[335.0]]), **keys)
        factors = np.full((1, SUBSTEPS, 2, 6), 1.05)
        return ClosedLoop(
            controller=controller,
            camera=Camera(np.array([[335.0]]), HALF[None, None], margin, rounded),
            plant=spacecraft(INERTIA),
            track=track(duration),
            step=1.0,
            substeps=SUBSTEPS,
            factors=lambda: factors,
            turning_axes=turning,
            frozen=frozen,
        )

    return build


@pytest.fixture(scope="session")
def fly(closed_loop: Callable[..., ClosedLoop]) -> Callable[..., Pointing]:
    return lambda *args, **keys: closed_loop(*args, **keys).run(np.zeros((1, 2, 3)))


@pytest.fixture(scope="session")
def mission(fly: Callable[..., Pointing]) -> Pointing:
    """Two control sections with the literal reading."""
    return fly(515)


class Turn(NamedTuple):
    """A turn towards a target that stands still: histories (step, run, ...)."""

    pixel: Array
    rate_b: Array
    torque: Array


@pytest.fixture(scope="session")
def turn() -> Callable[..., Turn]:
    """Turn from pixels and rates, all runs at once; plant and errors can differ by run."""

    def run(pixel0: Array, rate0: Array, seconds: float, plant=1.0, error=0.05, **keys) -> Turn:
        controller = Controller(spacecraft(INERTIA), np.array([[335.0]]), **keys)
        craft, pixel, rate = spacecraft(plant * INERTIA), pixel0[:, None], rate0[:, None]
        ray_c = np.concatenate([pixel / 335.0, np.ones((*pixel.shape[:-1], 1))], axis=-1)
        ray, angles, still = ray_c @ pinhole.BODY_TO_CAMERA, 0.0 * rate, 0.0 * rate
        memory, history = two_stage.start(np.rint(pixel), angles), []
        for _ in range(round(SUBSTEPS * seconds)):
            point = ray[..., None, :] @ euler.to_matrix(angles) @ pinhole.BODY_TO_CAMERA.T
            pixel = pinhole.project(point[..., 0, :], 335.0)
            seen = pinhole.in_view(point[..., 0, :], pixel, HALF)[..., None]
            measured = (1.0 + error) * angles, (1.0 + error) * rate
            torque, memory = two_stage.advance(
                controller, memory, np.where(seen, np.rint(pixel), np.nan), *measured, 0.02
            )
            history.append((pixel[:, 0], rate[:, 0], torque[:, 0]))
            angles, rate = craft.move(angles, rate, torque, still, 0.02)
        return Turn(*(np.array(x) for x in zip(*history)))

    return run
