"""The retraction of `model` as plain loops."""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

_SMALL = 1e-8


@compiled
def retracted(core: Array, error: Array) -> Array:
    """Return cores (run, n) moved by errors (run, n_c)."""
    moved = np.empty_like(core)
    for run in range(len(core)):
        x, y, z = 0.5 * error[run, 0], 0.5 * error[run, 1], 0.5 * error[run, 2]
        half = np.sqrt(x * x + y * y + z * z)
        cosine = np.cos(half)
        share = 1.0 - half * half / 6.0 if half < _SMALL else np.sin(half) / half
        x, y, z = share * x, share * y, share * z
        a, b, c, d = core[run, 0], core[run, 1], core[run, 2], core[run, 3]
        moved[run, 0] = a * cosine - b * x - c * y - d * z
        moved[run, 1] = a * x + b * cosine + c * z - d * y
        moved[run, 2] = a * y - b * z + c * cosine + d * x
        moved[run, 3] = a * z + b * y - c * x + d * cosine
        for k in range(4, core.shape[1]):
            moved[run, k] = core[run, k] + error[run, k - 1]
    return moved
