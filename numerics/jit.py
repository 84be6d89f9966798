"""Compilation of kernels: one set of options, one cache keyed by the sources."""

import fcntl
import gc
import hashlib
from collections.abc import Callable
from contextlib import ExitStack, suppress
from functools import wraps
from pathlib import Path
from typing import Any

import llvmlite.binding
import numba
from numba.core.compiler_lock import global_compiler_lock
from numba.core.runtime import rtsys

from joints.formula import KNOWN, kernel_options, shortcuts
from numerics.cache import cache_directory, make, mark_used


def widest_vectors() -> None:
    """Let kernels use all of a wide vector unit, where compilers by default keep to half of it.

    Rows of 64 blocks fill whole registers, so there is no short loop that this would slow down.
    """
    features = llvmlite.binding.get_host_cpu_features()
    if features.get("avx512f") and not numba.config.CPU_NAME:
        numba.config.CPU_NAME = llvmlite.binding.get_host_cpu_name()
        numba.config.CPU_FEATURES = f"{features.flatten()},-prefer-256-bit"


def shorter_compiling() -> None:
    """Disable LLVM passes that take a third of the compile time and make no kernel faster: runtime
    unrolling of vectorised loops, and strength reduction of addresses that x86 computes by
    itself. Versions of LLVM without these options would end the program."""
    if numba.version_info.short in KNOWN:
        llvmlite.binding.set_option("jointwave", "-unroll-runtime=false")
        llvmlite.binding.set_option("jointwave", "-disable-lsr")


widest_vectors()
shorter_compiling()
#: Where kernels are cached; numba forgets its own setting when one of its variables changes.
DIRECTORY = cache_directory(Path(__file__).resolve().parent.parent)
mark_used(DIRECTORY)


def jitted(function: Callable) -> Callable:
    """Compile a kernel: cached on disk, IEEE arithmetic (fastmath would break bit-identity).

    It must not take a kernel as an argument: numba's index of a cache cannot hold that.
    Kernels become part of their callers, so that absent parts fall away and loops over many
    blocks are vectorised; they hold no lock of Python's, so that threads run side by side.
    """
    return _compiled(function)


def jitted_for(*effects: Any) -> Callable:
    """Compile a kernel, as `jitted` does, that a factory makes for these effects.

    What else it closes over follows from them, so they tell its specialisations apart in the cache:
    it may hold formulas that are made for the same effects.
    """

    def compiled(function: Callable) -> Callable:
        kernel: Any = _compiled(function, effects)
        kernel._cache._index_key = lambda sig, codegen: (sig, codegen.magic_tuple(), repr(effects))
        return kernel

    return compiled


def inlined(function: Callable) -> Callable:
    """Compile a part of kernels, as `jitted` does, that only kernels call.

    Python cannot call it (it would crash): the code that would unpack a whole model at every part
    would take longer to compile than the parts.
    """
    return _compiled(function, no_cpython_wrapper=True)


def _compiled(function: Callable, effects: tuple = (), **options: Any) -> Callable:
    numba.config.CACHE_DIR = str(DIRECTORY)
    common = {"forceinline": True, "nogil": True, "no_cfunc_wrapper": True}
    kernel = numba.njit(
        cache=True, fastmath=False, error_model="numpy", **(common | kernel_options | options)
    )(function)
    kernel._cache.save_overload = _one_at_a_time(kernel._cache.save_overload)
    kernel._cache.load_overload = _without_registries(kernel._cache)
    lines = function.__module__, function.__qualname__, function.__code__.co_firstlineno
    name = hashlib.sha256(repr((lines, effects)).encode()).hexdigest()[:16]
    kernel.compile = _in_one_process(kernel.compile, f"{name}.lock")
    return kernel


def _in_one_process(compiling: Callable, lock: str) -> Callable:
    """Let one process at a time compile a kernel: others that want it, such as those of a run that
    MPI shares, wait and load it.

    No other thread may compile meanwhile: it could wait for this kernel, and this one for it. Nor
    is garbage looked for, which takes a sixth of the time: nearly all of what lives is in use.
    """

    def alone(signature: Any) -> Any:
        with global_compiler_lock, ExitStack() as held:
            if gc.isenabled():
                held.callback(_collect_later)
                gc.disable()
            with suppress(OSError):  # a cache that cannot be written
                make(DIRECTORY)
                file = held.enter_context((DIRECTORY / lock).open("w"))
                fcntl.flock(file, fcntl.LOCK_EX)
            with suppress(Exception), shortcuts():
                return compiling(signature)
            return compiling(signature)  # as numba does without them

    return alone


def _collect_later() -> None:
    """Look for garbage again; what there is by now, at the next full search alone."""
    gc.freeze()
    gc.unfreeze()
    gc.enable()


def _without_registries(cache: Any) -> Callable:
    """Return numba's loading of a cached kernel, without its registries of what it can compile.

    They take a third of a second to read, and nothing of them is needed to call machine code; where
    nothing is cached, the compiler reads them itself.
    """

    def load(signature: Any, target: Any) -> Any:
        rtsys.initialize(target)
        with cache._guard_against_spurious_io_errors():
            return cache._load_overload(signature, target)

    return load


def _one_at_a_time(save: Callable) -> Callable:
    """Let one process at a time enter what it has compiled into the cache.

    numba reads a kernel's index, adds to it and writes it back. Two processes at once would give
    two specialisations the same file, and one of them would run the other's code.
    """

    @wraps(save)
    def alone(*arguments: Any) -> None:
        make(DIRECTORY)
        with (DIRECTORY / "lock").open("w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            save(*arguments)

    return alone
