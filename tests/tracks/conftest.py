"""A tumbling body as text: written by hand here, so that no reader is tested by its own writer."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array
from debrisest.errors import UserError

BODY = np.array(
    [[1.2, 0.1, -0.3], [-0.4, 0.9, 0.5], [0.2, -1.1, 0.7], [-0.8, -0.3, -0.6], [0.5, 0.6, 1.0]]
)
Write = Callable[..., Path]


def motion(epochs: int = 9, noise: float = 1e-4) -> tuple[Array, Array]:
    """Times and points (epoch, feature, 3) of a body that turns 20 degrees a step, 10 m away."""
    times = 0.5 * np.arange(epochs)
    turn = Rotation.from_rotvec(np.radians(20.0) * np.outer(np.arange(epochs), [0.36, 0.48, 0.8]))
    points = np.array([1.0, 10.0, -2.0]) + np.einsum("nij,fj->nfi", turn.as_matrix(), BODY)
    return times, points + noise * np.random.default_rng(3).normal(size=points.shape)


def long_text(times: Array, points: Array) -> str:
    rows = [
        f"{t:.3f},p{f + 1},{points[n, f, 0]:.6f},{points[n, f, 1]:.6f},{points[n, f, 2]:.6f},0.01"
        for n, t in enumerate(times)
        for f in range(points.shape[1])
    ]
    return "\n".join(["time_s,feature,x_m,y_m,z_m,sigma_m", *rows]) + "\n"


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Write text or bytes to a file of this test."""

    def file(content: str | bytes, name: str = "data.csv") -> Path:
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return file


def refusal(call: Callable[[], object]) -> str:
    """What a call refuses, in words."""
    with pytest.raises(UserError) as caught:
        call()
    return str(caught.value)
