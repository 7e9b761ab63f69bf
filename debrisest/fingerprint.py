"""What numbers depend on beside a scenario: the code, and the versions below it."""

import platform
from functools import cache
from hashlib import sha256
from importlib import import_module
from pathlib import Path

from debrisest import compiled

_BELOW = ("numpy", "scipy", "h5py", "pydantic")


@cache
def fingerprint() -> dict[str, str]:
    """Return the versions of what is imported, and of this package a digest of its source."""
    package = Path(__file__).parent
    source = sha256()
    for path in sorted(package.rglob("*.py")):
        source.update(f"{path.relative_to(package).as_posix()}\0".encode() + path.read_bytes())
    versions = {name: str(import_module(name).__version__) for name in _BELOW}
    versions["numba"] = compiled.version()
    return {"debrisest": source.hexdigest()[:16], "python": platform.python_version(), **versions}
