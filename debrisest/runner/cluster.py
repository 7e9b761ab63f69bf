"""A dask cluster behind the executor interface (extra ``dask``).

Its workers read and write the files themselves: the folder of results must be a shared one, by the
same path everywhere. They compute only after they proved to have the same code and versions.
"""

import logging
import threading
import time
import warnings
from asyncio import CancelledError as AsyncCancelledError
from collections.abc import Callable, Iterator
from concurrent.futures import (
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    InvalidStateError,
)
from contextlib import contextmanager, suppress
from typing import Any

from debrisest.errors import UserError
from debrisest.fingerprint import fingerprint

PATIENCE_S = 30.0
"""How long a cluster may be without a worker."""
_CHECKED_EVERY_S = 1.0
_LOGGERS = ("distributed", "tornado", "asyncio")
"""What tells of a lost connection in its own way; loggers below these have levels of their own."""
_LOST = "the connection to the dask scheduler was lost; start it and run again"
_PROOF = "__import__('debrisest.fingerprint', fromlist=['x']).fingerprint()"


class ClusterLost(BrokenExecutor):
    """The cluster can compute no further; the message says why."""


@contextmanager
def dask_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """Yield the executor of the dask scheduler at ``dask:tcp://HOST:PORT``.

    Raises UserError where no scheduler answers, no worker is there, or one has other code.
    """
    kind, _, scheduler = address.partition(":")
    if kind != "dask" or not scheduler:
        raise UserError(f"--executor {address}: expected dask:tcp://HOST:PORT")
    try:
        from distributed import Client
    except ImportError:
        raise UserError("--executor needs the extra dask: pip install 'debrisest[dask]'") from None
    for name in (*_LOGGERS, *logging.root.manager.loggerDict):
        if name.partition(".")[0] in _LOGGERS:
            logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings(action="ignore"):  # of other versions, which we tell ourselves
            client = Client(scheduler, timeout=10, set_as_default=False)
    except (OSError, ValueError, TimeoutError):
        raise UserError(f"--executor {address}: no dask scheduler answers there") from None
    try:
        _prove_workers(client, address)
        with _Cluster(client) as cluster:
            yield cluster, max(sum(client.nthreads().values()), 1)
    finally:
        with suppress(Exception):
            client.close(timeout=2)


def run_proven(expected: dict[str, str], fn: Callable[..., Any], *args: Any) -> Any:
    """Call a function on a worker whose fingerprint is the expected one; else ValueError."""
    if differing := _differing(fingerprint(), expected):
        raise ValueError(f"this worker has other versions: {differing}; nothing was computed")
    return fn(*args)


class _Cluster(Executor):
    """Submits to proven workers, and ends what is running where no worker is left."""

    def __init__(self, client: Any) -> None:
        self._client, self._pool = client, client.get_executor()
        self._running: dict[Future[Any], Any] = {}
        self._over = threading.Event()
        threading.Thread(target=self._watch, daemon=True).start()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **_: Any) -> Future[Any]:
        """Submit a call; its future ends with ClusterLost where the cluster does."""
        ours: Future[Any] = Future()
        theirs = self._pool.submit(run_proven, fingerprint(), fn, *args)
        self._running[ours] = theirs
        theirs.add_done_callback(lambda done: self._finish(ours, done))
        return ours

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Stop watching; what is left on the cluster is dropped with the client."""
        self._over.set()

    def _finish(self, ours: Future[Any], theirs: Any) -> None:
        """Hand a result on; a client that loses its scheduler cancels what it waits for."""
        self._running.pop(ours, None)
        error = CancelledError() if theirs.cancelled() else theirs.exception()
        if isinstance(error, CancelledError | AsyncCancelledError):
            error = ClusterLost(_LOST)
        with suppress(InvalidStateError):
            ours.set_exception(error) if error else ours.set_result(theirs.result())

    def _watch(self) -> None:
        seen = time.monotonic()
        while not self._over.wait(_CHECKED_EVERY_S):
            try:
                if self._client.status != "running":
                    raise OSError
                seen = time.monotonic() if self._client.nthreads() else seen
            except Exception:
                self._lose(_LOST)
                return
            if time.monotonic() - seen > PATIENCE_S:
                said = f"the dask cluster had no worker for {PATIENCE_S:g} s"
                self._lose(f"{said}; start one and run again to go on")
                return

    def _lose(self, why: str) -> None:
        for ours in list(self._running):
            with suppress(Exception):
                ours.set_exception(ClusterLost(why))


def _prove_workers(client: Any, address: str) -> None:
    """Raise UserError where no worker is there in time, or one is not like this process."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE_S)
    except TimeoutError:
        raise UserError(
            f"--executor {address}: no worker joined the scheduler within {PATIENCE_S:g} s; "
            f"start one: dask worker {address.partition(':')[2]}"
        ) from None
    problems = []
    for worker, found in client.run(eval, _PROOF, on_error="return").items():
        if isinstance(found, BaseException):
            said = f"it has no debrisest like this one ({type(found).__name__}: {found})"
        else:
            said = _differing(found, fingerprint())
        if said:
            problems.append(f"--executor {address}: worker {worker}: {said}; install the same")
    if problems:
        raise UserError(problems)


def _differing(found: dict[str, str], expected: dict[str, str]) -> str:
    """Return the versions that are others than expected, in words."""
    return ", ".join(
        f"{name} {found.get(name, 'none')} (expected {wanted})"
        for name, wanted in expected.items()
        if found.get(name) != wanted
    )
