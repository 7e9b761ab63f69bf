"""A dask cluster behind the executor interface (extra ``dask``).

Its workers read and write the files themselves: the folder of results must be a shared one.
"""

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from debrisest.errors import UserError


@contextmanager
def dask_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """Yield the executor of the dask scheduler at ``dask:tcp://HOST:PORT``."""
    kind, _, scheduler = address.partition(":")
    if kind != "dask" or not scheduler:
        raise UserError(f"--executor {address}: expected dask:tcp://HOST:PORT")
    try:
        from distributed import Client
    except ImportError:
        raise UserError("--executor needs the extra dask: pip install 'debrisest[dask]'") from None
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError, TimeoutError):
        raise UserError(f"--executor {address}: no dask scheduler answers there") from None
    with client:
        yield client.get_executor(), max(sum(client.nthreads().values()), 1)
