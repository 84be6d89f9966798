"""Compilation of kernels: one set of options, one cache keyed by the sources."""

import logging
from collections.abc import Callable
from contextlib import suppress
from functools import cache, wraps
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba
import numpy as np

from jointwave.numerics.cache import cache_directory, make, mark_used, one_process

WAIT = 1.5  # s, after which compiling is announced: cached kernels load in less, also under load

#: Where kernels are cached; numba forgets its own setting when one of its variables changes.
DIRECTORY = cache_directory(Path(__file__).resolve().parent.parent)
mark_used(DIRECTORY)


def jitted(function: Callable, flags: Any = None) -> Callable:
    """Compile a kernel for the types of its arguments when it is first called with them.

    It is cached on disk, has IEEE arithmetic (fastmath would break bit-identity), and holds no
    lock of Python's, so that threads run side by side. What it closes over is constant.

    flags : the constants that decide what it closes over, plain values in tuples. Each has a name
    in the cache, so that several processes compile kernels of different flags at the same time.
    """
    if flags is not None:
        function.__qualname__ += f".{sha256(repr(flags).encode()).hexdigest()[:8]}"
    numba.config.CACHE_DIR = str(DIRECTORY)
    options = {"cache": True, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
    kernel = numba.njit(**options)(function)
    known = set()

    @wraps(function)
    def call(*arguments: Any) -> Any:
        kinds = kind(arguments)
        if kinds not in known:  # numba's types of all arrays of a model take longer than a step
            types = tuple(map(numba.typeof, arguments))
            if types not in kernel.overloads:
                compile_for(kernel, types)
            known.add(kinds)
        return kernel(*arguments)

    return call


def kind(value: Any) -> Any:
    """Return what decides numba's type of an argument."""
    if isinstance(value, np.ndarray):
        return value.dtype, value.ndim, value.flags.num
    if isinstance(value, tuple):
        return (type(value), *map(kind, value))
    return type(value)


def compile_for(kernel: Any, types: tuple) -> None:
    """Load a kernel from the cache, or compile and save it; one process at a time per function.

    Others that want it, such as those of a run that MPI shares, wait and load it. numba reads the
    index of a function, adds to it and writes it back: two processes at once would give two
    specialisations the same file.
    """
    function = kernel.py_func
    name = f"{function.__module__}.{function.__qualname__}.lock"
    with suppress(OSError):  # a cache that cannot be written
        make(DIRECTORY)
    with one_process(DIRECTORY / name, WAIT, announce):
        kernel.compile(types)


@cache
def announce() -> None:
    """Log once that compiling takes a while."""
    logging.getLogger("jointwave").info(
        "compiling kernels for the effects of this scene; later runs load them"
    )
