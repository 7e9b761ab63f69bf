"""Batch experiments on estimating the motion of tumbling space debris from vision.

The calls of a notebook are here; each is imported when it is first asked for.
"""

from importlib import import_module

TYPE_CHECKING = False  # that of typing costs as much as the start of Python, where none listens
if TYPE_CHECKING:
    from debrisest.errors import UserError
    from debrisest.notebook import estimate, load, run, schema
    from debrisest.results.open import open_results

__version__ = version = "0.1.0"
__all__ = [
    "UserError",
    "__version__",
    "estimate",
    "load",
    "open_results",
    "run",
    "schema",
    "version",
]

_HOME = {
    "UserError": "debrisest.errors",
    "estimate": "debrisest.notebook",
    "load": "debrisest.notebook",
    "open_results": "debrisest.results.open",
    "schema": "debrisest.notebook",
    "run": "debrisest.notebook",
}


def __getattr__(name: str) -> object:
    """Import a call and return it."""
    if name not in _HOME:
        raise AttributeError(f"module 'debrisest' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    """Return the names that can be asked for."""
    return sorted({*globals(), *_HOME})
