"""Running the points of studies in processes, and the keys under which they are saved."""

import gc
import hashlib
import json
import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, suppress
from functools import partial
from importlib import import_module
from multiprocessing.resource_tracker import ensure_running
from pathlib import Path
from signal import SIG_BLOCK, SIG_SETMASK, SIGINT, pthread_sigmask
from tempfile import gettempdir
from typing import Any, TypeVar

from joblib import Parallel, delayed

from jointwave.cases.errors import SceneError, UnstableError
from jointwave.compare.runs.checkpoint.lock import exclusive
from jointwave.compare.runs.checkpoint.signature import program
from jointwave.compare.runs.processes import Processes

P = TypeVar("P")
T = TypeVar("T")
Row = dict[str, Any]  #: the readings of a point, by column
#: Yields the name and result of each point when it is done; result None: its process has died.
Pool = Callable[[Callable[[Any], Any], Mapping[str, Any]], Iterator[tuple[str, Any]]]

FAILURES = (SceneError, UnstableError)  # of an invalid scene, or an unstable run
DIED = "its process ended early, possibly for lack of memory"


def reason_of(error: Exception) -> str:
    """Return the reason of a failure: the key and what is allowed, without the file."""
    return f"{error.key} {error.allowed}".strip() if isinstance(error, SceneError) else str(error)


def key(*about: Any) -> str:
    """Return the key of a point: a hash of the data that determine it (JSON) and of the program."""
    text = json.dumps([*about, program()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def in_processes(
    count: int, work: Callable[[P], T], points: Mapping[str, P]
) -> Iterator[tuple[str, T | None]]:
    """Compute points in `count` processes of this machine; 1: in this process.

    If a process dies, all end; the remaining points are then computed one at a time.
    """
    left = dict(points)
    try:
        for name, result in _parallel(count, work, points):
            del left[name]
            yield name, result
    except BrokenProcessPool:
        for name, point in left.items():
            try:
                yield from _parallel(2, work, {name: point})
            except BrokenProcessPool:
                yield name, None


def _parallel(
    count: int, work: Callable[[P], T], points: Mapping[str, P]
) -> Iterator[tuple[str, T]]:
    """Yield named results in order of completion."""
    # joblib warns when it replaces a worker that uses too much memory, which loses no point, and
    # when it is interrupted.
    for message in ("A worker stopped while some jobs", r"\d+ tasks which were still being"):
        warnings.filterwarnings("ignore", message, UserWarning)
    run = Parallel(
        count, return_as="generator_unordered", pre_dispatch=count, batch_size=1, max_nbytes=None
    )
    about = work, Path.cwd(), count > 1
    if count > 1:
        ensure_running()  # of Python: when it starts, it unblocks signals (up to Python 3.12)
    # Workers inherit the blocked Ctrl-C, and ignore it: this process gets it below, and ends them.
    before = pthread_sigmask(SIG_BLOCK, [SIGINT])
    try:
        found = run(delayed(_named)(*one, *about) for one in points.items())
    finally:
        pthread_sigmask(SIG_SETMASK, before)
    yield from found


def _named(
    name: str, point: P, work: Callable[[P], T], folder: Path, is_worker: bool
) -> tuple[str, T]:
    """Work on a point. A worker then freezes its objects, mostly compiled kernels: joblib collects
    garbage after each point, which takes half a second with a million objects of numba."""
    os.chdir(folder)  # workers outlive a call and stay in the folder of the first one
    result = work(point)
    if is_worker:
        gc.collect()
        gc.freeze()
    return name, result


def on_executor(
    executor: Executor, work: Callable[[P], T], points: Mapping[str, P]
) -> Iterator[tuple[str, T]]:
    """Yield named results of points computed on an executor, in order of completion."""
    futures = {executor.submit(work, point): name for name, point in points.items()}
    for future in as_completed(futures):
        yield futures[future], future.result()


def on_pool(processes: Processes, workers: int, work: Callable[[Pool | None], T]) -> T | None:
    """Return the result of `work(pool)`. Under MPI the first process distributes points to the
    others, which return None when it is done.

    workers : number of processes without MPI; 1: only this one.
    """
    if processes.comm is None:
        return work(partial(in_processes, workers))
    from mpi4py.futures import MPICommExecutor

    with suppress(ImportError):  # PETSc starts on all processes together: one alone would wait
        import_module("jointwave.continuum.space.fenicsx")
    with MPICommExecutor(processes.comm, root=0) as executor:
        return None if executor is None else work(partial(on_executor, executor))


def alone() -> AbstractContextManager[None]:
    """Return a lock that waits until no other timed study runs on this machine."""
    return exclusive(Path(gettempdir()), wait=True)
