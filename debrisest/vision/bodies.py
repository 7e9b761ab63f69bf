"""Bodies to be photographed, whose mass properties are known exactly."""

from collections.abc import Callable

import numpy as np

from debrisest.vision.solids import Solid, box, joined, revolved, turned

_BRIGHT, _DARK = 0.85, 0.45
_ALONG_X = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def h10() -> Solid:
    """Return a spent rocket stage along x: a cylinder of 11.53 m x 2.66 m with a nozzle."""
    profile = [(0.0, -7.2), (0.85, -7.2), (0.35, -5.765), (1.33, -5.765), (1.33, 5.765)]
    return turned(revolved([*profile, (0.0, 5.765)], _BRIGHT), _ALONG_X)


def panelled_satellite() -> Solid:
    """Return a box with two panels 8 cm thick on yokes, and a solid dish."""
    bus = box((0.0, 0.0, 0.0), (1.6, 1.8, 2.2), _BRIGHT)
    wings = [
        part
        for side in (-1.0, 1.0)
        for part in (
            box((0.0, side * 1.2, 0.0), (0.12, 0.6, 0.12), 0.7),
            box((0.0, side * 3.0, 0.0), (0.08, 3.0, 1.6), _DARK),
        )
    ]
    dish = revolved([(0.0, 1.1), (0.1, 1.1), (0.1, 1.3), (0.7, 1.6), (0.7, 1.7), (0.0, 1.7)], 0.9)
    return joined(bus, *wings, dish)


def simulator() -> Solid:
    """Return a platform like that of a laboratory's attitude simulator: a disc with boxes."""
    disc = revolved([(0.0, -0.03), (0.4, -0.03), (0.4, 0.03), (0.0, 0.03)], 0.7)
    boxes = [
        box((0.18, 0.12, 0.13), (0.22, 0.16, 0.2), _BRIGHT),
        box((-0.16, 0.14, 0.09), (0.18, 0.2, 0.12), 0.6),
        box((-0.05, -0.2, 0.155), (0.3, 0.14, 0.25), 0.75),
        box((0.1, -0.05, -0.1), (0.26, 0.3, 0.14), _BRIGHT),
    ]
    return joined(disc, *boxes)


def plain_box() -> Solid:
    """Return a box of 2 m x 1.6 m x 1.2 m."""
    return box((0.0, 0.0, 0.0), (2.0, 1.6, 1.2), _BRIGHT)


BODIES: dict[str, Callable[[], Solid]] = {
    "h10": h10,
    "panelled_satellite": panelled_satellite,
    "simulator": simulator,
    "box": plain_box,
}
"""The bodies by name, in axes in which they are easily built."""
