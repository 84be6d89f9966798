"""Compilation of kernels: one set of options, one cache keyed by the sources."""

import logging
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, wraps
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba
import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.numerics.cache import cache_directory, make, mark_used, one_process

WAIT = 1.5  # s, after which compiling is announced: cached kernels load in less, also under load

#: numba's threading layers, best first: OpenMP's threads spin while they wait, 2 us for each loop;
#: those of the others sleep, 150 us.
LAYERS = ["omp", "tbb", "workqueue"]
#: Kinds of parallel code that numba is not to make.
OTHERS = "comprehension", "reduction", "inplace_binop", "setitem", "numpy", "stencil", "fusion"

#: Directory of the cache, set for each kernel: numba resets its own when its environment changes.
DIRECTORY = cache_directory(Path(__file__).resolve().parent.parent)
mark_used(DIRECTORY)


def jitted(function: Callable, flags: Any = None, threaded: bool = False) -> Callable:
    """Compile a kernel for the types of its arguments when it is first called with them.

    It is cached on disk, has IEEE arithmetic (fastmath would break bit-identity), and releases the
    GIL for threads. Variables of its closure are constants.

    flags : nested tuples of plain values that determine the closure. They are part of the name in
    the cache, so that several processes can compile kernels of different flags at the same time.
    threaded : whether loops over `prange` are shared by threads, see `limited_threads`.
    """
    if numba.config.DISABLE_JIT:
        raise SceneError("NUMBA_DISABLE_JIT", "", None, "must be 0: both engines are compiled")
    if flags is not None:
        function.__qualname__ += f".{sha256(repr(flags).encode()).hexdigest()[:8]}"
    numba.config.CACHE_DIR = str(DIRECTORY)
    options = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
    if threaded:
        options["parallel"] = {"prange": True} | dict.fromkeys(OTHERS, False)
    try:
        kernel = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # neither our cache, nor numba's own, nor the sources can be written
        kernel = numba.njit(**options)(function)
    known = set()

    @wraps(function)
    def call(*arguments: Any) -> Any:
        kinds = kind(arguments)
        if kinds not in known:  # numba.typeof of all arrays of a model takes longer than a step
            types = tuple(map(numba.typeof, arguments))
            if types not in kernel.overloads:
                compile_for(kernel, types)
            known.add(kinds)
        return kernel(*arguments)

    return call


@contextmanager
def limited_threads(count: int) -> Iterator[None]:
    """Let the loops of threaded kernels use at most `count` threads, as long as this holds."""
    if "NUMBA_THREADING_LAYER_PRIORITY" not in os.environ:
        numba.config.THREADING_LAYER_PRIORITY = LAYERS
    before = numba.get_num_threads()
    numba.set_num_threads(min(count, numba.config.NUMBA_NUM_THREADS))
    try:
        yield
    finally:
        numba.set_num_threads(before)


def kind(value: Any) -> Any:
    """Return a cheap key that determines numba's type of an argument."""
    if isinstance(value, np.ndarray):
        return value.dtype, value.ndim, value.flags.num
    if isinstance(value, tuple):
        return (type(value), *map(kind, value))
    return type(value)


def compile_for(kernel: Any, types: tuple) -> None:
    """Load a kernel from the cache, or compile and save it; one process at a time per function.

    Other processes, as of an MPI run, wait and then load it. numba reads a function's index, adds
    to it and writes it back: two processes at once would give two specialisations the same file.
    """
    function = kernel.py_func
    name = f"{function.__module__}.{function.__qualname__}.lock"
    with suppress(OSError):  # the cache is not writable
        make(DIRECTORY)
    with one_process(DIRECTORY / name, WAIT, announce):
        kernel.compile(types)


@cache
def announce() -> None:
    """Log once that compiling takes a while."""
    logging.getLogger("jointwave").info(
        "compiling kernels for the effects of this scene; later runs load them"
    )
