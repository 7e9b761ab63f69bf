"""Figures from the results of a scenario.

They are written by canvases of their own. Matplotlib ends its import where the environment names a
backend that is not installed, such as a notebook's: it is imported without, and told afterwards.
"""

import os
from contextlib import suppress

_backend = os.environ.pop("MPLBACKEND", None)
import matplotlib  # noqa: E402

if _backend is not None:
    os.environ["MPLBACKEND"] = _backend
    with suppress(ValueError):
        matplotlib.rcParams["backend"] = _backend
