"""Inner loops that numba compiles, where the extra ``fast`` is installed.

Each kernel is a file of plain loops beside numpy code that says the same. That code runs without
numba, where numba cannot be imported, and where the environment has ``DEBRISEST_COMPILED=0``.
"""

import gc
import os
import sys
from collections.abc import Callable
from contextlib import ExitStack, suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar, cast

from debrisest.files import lock

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
    return _compiled(kernel)


def compiled_sum(kernel: Kernel) -> Kernel:
    """The same of loops that only add up: in any order, so that the sums become vectors."""
    return _compiled(kernel, fastmath={"reassoc", "contract", "nsz"})


def _compiled(kernel: Kernel, **options: Any) -> Kernel:
    import numba

    config: Any = numba.config
    given = config.CACHE_DIR
    config.CACHE_DIR = str(folder := _cache(kernel, given))
    try:
        loops: Any = numba.njit(cache=True, error_model="numpy", **options)(kernel)
        own = folder / f"{kernel.__module__}.{kernel.__qualname__}.lock"
        loops.compile = _by_one_process(loops.compile, own)
        return cast(Kernel, loops)
    except RuntimeError:
        return cast(Kernel, numba.njit(error_model="numpy", **options)(kernel))
    finally:
        config.CACHE_DIR = given


def _cache(kernel: Callable[..., object], given: str) -> Path:
    """Return a folder that is named after the source of all loops that a kernel can call.

    Numba looks for changes in a kernel's own file alone, not in those of the kernels that it calls.
    """
    names, package = _reached(kernel.__module__), Path(__file__).parent
    source = b"".join(Path(str(sys.modules[name].__file__)).read_bytes() for name in names)
    return Path(given or package / "__pycache__") / f"loops-{sha256(source).hexdigest()[:16]}"


def _reached(module: str) -> list[str]:
    """Return the modules of loops whose kernels a module has, its own with them, sorted."""
    found, left = {module}, [module]
    while left:
        values = vars(sys.modules[left.pop()]).values()
        of = {str(getattr(value, "__module__", "")) for value in values}
        left += (new := {name for name in of if name.endswith("_loops")} - found)
        found |= new
    return sorted(found)


def _by_one_process(compile: Callable[[Any], Any], path: Path) -> Callable[[Any], Any]:
    """Return what compiles a kernel, in one process at a time: the next has it from the cache.

    Where a file system has no locks, each process compiles. Garbage is left until the outermost
    kernel is done, since to look for it takes a tenth of the time.
    """

    def compile_alone(signature: Any) -> Any:
        with ExitStack() as held:
            if gc.isenabled():
                gc.disable()
                held.callback(gc.enable)
            with suppress(OSError):
                path.parent.mkdir(parents=True, exist_ok=True)
                lock(held.enter_context(path.open("a")).fileno(), wait=True)
            return compile(signature)

    return compile_alone
