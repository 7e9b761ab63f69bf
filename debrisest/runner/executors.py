"""Where steps are computed: in this process, in a pool of processes, or on a cluster."""

import errno
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, InvalidStateError, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from typing import Any

from debrisest.counted import Listener, Part, listen, listener

UNGUARDED = (
    "debrisest starts worker processes, and each of them imports your script: put the lines that "
    'run something below  if __name__ == "__main__":  or use jobs=1'
)


class InProcess(Executor):
    """An executor that computes at once, in this process."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Compute now and return a finished future."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class WorkerPool(ProcessPoolExecutor):
    """Spawned processes that leave Ctrl-C to this one, tell it their parts, and end with it."""

    def __init__(self, jobs: int) -> None:
        spawn = multiprocessing.get_context("spawn")
        heard, self._told = spawn.Pipe(duplex=False)
        with _semaphores_told():
            given = self._told, spawn.Lock()
            super().__init__(jobs, mp_context=spawn, initializer=_follow_parent, initargs=given)
        self._asked: list[Future[Any]] = []
        self._lost = False
        with _threads_told():
            threading.Thread(target=_pass_on, args=(heard, listener()), daemon=True).start()
        self._hook, threading.excepthook = threading.excepthook, self._thread_lost

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submit as the pool does, starting workers with Ctrl-C blocked."""
        with _blocked_ctrl_c(), _threads_told():
            future = super().submit(fn, *args, **kwargs)
        self._asked = [*(one for one in self._asked if not one.done()), future]
        if self._lost:
            self._give_up()
        return future

    def _thread_lost(self, lost: threading.ExceptHookArgs) -> None:
        """Give up where a thread of the pool ends by an error, after which nobody is answered."""
        if not _lacks_a_thread(lost.exc_value):
            self._hook(lost)
        self._lost = True
        self._give_up()

    def _give_up(self) -> None:
        for future in self._asked:
            with suppress(InvalidStateError):
                future.set_exception(_no_thread())

    def __exit__(self, *error: Any) -> None:
        """Wait for the workers, or end them where an error leaves the pool, or one was in it."""
        threading.excepthook = self._hook
        self._told.close()
        if error[0] is None and not self._lost:
            self.shutdown()
            return
        self.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.terminate()


def require_guarded(jobs: int) -> None:
    """End a worker, with a sentence, that imports a script which starts workers itself."""
    if jobs > 1 and getattr(multiprocessing.current_process(), "_inheriting", False):
        raise SystemExit(UNGUARDED)


@contextmanager
def executor(jobs: int, address: str | None = None) -> Iterator[tuple[Executor, int]]:
    """Yield an executor and how many steps it computes at a time.

    It is this process, a pool of ``jobs`` spawned ones, or a dask cluster.
    """
    if address is not None:
        from debrisest.runner.cluster import dask_executor

        with dask_executor(address) as cluster:
            yield cluster
    else:
        with InProcess() if jobs == 1 else WorkerPool(jobs) as pool:
            yield pool, jobs


@contextmanager
def _blocked_ctrl_c() -> Iterator[None]:
    """Block Ctrl-C where a process can: those that it starts begin with what it blocks."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _pass_on(heard: Connection, who: Listener) -> None:
    """Pass on what workers tell, until the last one has ended."""
    with suppress(EOFError, OSError):
        while True:
            who(heard.recv())


def _follow_parent(told: Connection, lock: Any) -> None:
    """Ignore Ctrl-C in a worker, tell its parent of parts, and end it when that ends, anyhow."""

    def send(part: Part) -> None:
        with lock, suppress(OSError):
            told.send(part)

    listen(send)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def wait() -> None:
        parent.join()
        os._exit(1)

    try:
        threading.Thread(target=wait, daemon=True).start()
    except RuntimeError:
        os._exit(1)


@contextmanager
def _semaphores_told() -> Iterator[None]:
    """Raise OSError that says what to do where processes cannot share a lock: without /dev/shm."""
    try:
        yield
    except (OSError, ImportError) as error:
        said = getattr(error, "strerror", None) or str(error)
        place = "several processes need semaphores (on Linux /dev/shm)"
        raise OSError(errno.ENOSYS, f"{said}; --jobs 1 needs none", place) from None


@contextmanager
def _threads_told() -> Iterator[None]:
    """Raise OSError, as for a process, where the system starts no more threads."""
    try:
        yield
    except RuntimeError as error:
        raise (_no_thread() if _lacks_a_thread(error) else error) from None


def _lacks_a_thread(error: BaseException | None) -> bool:
    return isinstance(error, RuntimeError) and "new thread" in str(error)


def _no_thread() -> OSError:
    return OSError(errno.EAGAIN, os.strerror(errno.EAGAIN))
