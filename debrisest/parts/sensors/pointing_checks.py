"""What the pointing control needs of clock, camera and orbits, each refusal in a sentence."""

from collections.abc import Iterable, Sequence

import numpy as np

from debrisest.arrays import Array, BoolArray

_MOST = 10_000


def control_steps(step: float, control_step: float) -> int:
    """Return the number of control steps, s, between epochs that are ``step`` seconds apart."""
    if not step / _MOST <= control_step <= step:
        raise ValueError(
            f"control_step_s, {control_step:g} s, must be at most step_s, {step:g} s, "
            f"and at least step_s / {_MOST}"
        )
    return int(np.ceil(step / control_step - 1e-9))


def require_known(given: Iterable[str], observers: Sequence[str]) -> None:
    """Refuse names of satellites that the scenario does not have."""
    for name in given:
        if name not in observers:
            raise ValueError(
                f"satellites: no observer is called {name}; there are {', '.join(observers)}"
            )


def require_room(margin: float, half_size: Array) -> None:
    """Refuse a margin, px, that leaves no middle of images ``half_size (run, 2)``."""
    if margin >= half_size.min():
        raise ValueError(
            f"margin_px, {margin:g} px, must be less than the camera's half_size_px, "
            f"{half_size.min():g} px: the debris would always be too near to an edge"
        )


def require_view(visible: BoolArray) -> None:
    """Refuse runs in which no camera sees the debris at the start, ``visible (run, camera)``."""
    if not visible.any(-1).all():
        raise ValueError(
            "no camera sees the debris at the start: it is behind them or outside their images; "
            "change the orbits, the camera's focal_px or half_size_px"
        )
