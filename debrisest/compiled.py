"""Inner loops that numba compiles, where the extra ``fast`` is installed.

Each kernel is a file of plain loops beside numpy code that says the same. That code runs without
numba, where numba cannot be imported, and where the environment has ``DEBRISEST_COMPILED=0``.
"""

import os
from collections.abc import Callable
from functools import cache
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from importlib.util import find_spec
from typing import TypeVar, cast

Kernel = TypeVar("Kernel", bound=Callable[..., object])


@cache
def version() -> str:
    """Return the version of numba that is installed and wanted, or nothing; imports nothing."""
    try:
        wanted = os.environ.get("DEBRISEST_COMPILED") != "0"
        return version_of("numba") if wanted and find_spec("numba") else ""
    except PackageNotFoundError:
        return ""


@cache
def available() -> bool:
    """Return whether kernels run compiled in this process."""
    try:
        return bool(version() and __import__("numba"))
    except ImportError:
        return False


def compiled(kernel: Kernel) -> Kernel:
    """Return the loops compiled, by the cache on disk where there is a place for one."""
    from numba import njit

    try:
        return cast(Kernel, njit(cache=True, error_model="numpy")(kernel))
    except RuntimeError:
        return cast(Kernel, njit(error_model="numpy")(kernel))
