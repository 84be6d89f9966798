"""Worker processes of this machine that end exactly when their parent does."""

import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from multiprocessing import active_children, get_context
from threading import Lock
from types import TracebackType
from typing import Any

from jointwave.compare.runs.memory import collect_rarely

STARTING = Lock()  # held while a worker may start: the environment is that of the whole process


class Workers(ProcessPoolExecutor):
    """The standard pool, of spawned processes.

    Ctrl-C reaches all processes of a terminal; the workers ignore it. If the program ends early,
    they are terminated too. BLAS has one thread in each: with as many workers as cores its threads
    would wait for one another, a millisecond for every small matrix.
    """

    def __init__(self, count: int, module: str | None = None) -> None:
        """Start no worker yet; with a module all of them, which import it meanwhile."""
        super().__init__(count, get_context("spawn"), _begin, (module,))
        for _ in range(count if module else 0):
            self.submit(os.getpid)  # each starts a worker

    def submit(self, work: Callable[..., Any], /, *arguments: Any, **more: Any) -> Future:
        """Submit work to a worker, starting one if none is free."""
        # Also in workers started now, permanently. Several threads may submit.
        with STARTING, _held_back(signal.SIGINT), _one_blas_thread():
            return super().submit(work, *arguments, **more)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is not None and not issubclass(kind, Exception):
            for worker in active_children():
                worker.terminate()
        self.shutdown(cancel_futures=kind is not None)


def _begin(module: str | None) -> None:
    collect_rarely()
    if module is not None:
        import_module(module)


@contextmanager
def _held_back(number: signal.Signals) -> Iterator[None]:
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {number})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _one_blas_thread() -> Iterator[None]:
    known = os.environ.get(name := "OPENBLAS_NUM_THREADS")
    os.environ[name] = known or "1"
    try:
        yield
    finally:
        if known is None:
            del os.environ[name]
