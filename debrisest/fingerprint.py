"""What numbers depend on beside a scenario: the code, and the versions below it."""

import platform
from functools import cache
from importlib import import_module

from debrisest import compiled
from debrisest.revision import digest

_BELOW = ("numpy", "scipy", "h5py", "pydantic")


@cache
def fingerprint() -> dict[str, str]:
    """Return the versions of what is imported, and of this package a digest of its source."""
    versions = {name: str(import_module(name).__version__) for name in _BELOW}
    versions["numba"] = compiled.version()
    return {"debrisest": digest(), "python": platform.python_version(), **versions}
