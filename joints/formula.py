"""The decorator of formulas: plain Python functions that numba compiles into its kernels."""

from collections.abc import Callable

from numba.extending import register_jitable

_inlined = register_jitable(
    forceinline=True, error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=True
)


def formula(function: Callable) -> Callable:
    """Return a function that Python can call and that kernels inline, with IEEE arithmetic. Its
    compiled code is called from kernels only, so it has no wrappers."""
    # Both names are one object in modules compiled from source, two in those loaded from bytecode:
    # numba's cache would have other keys, and compile each kernel twice.
    function.__globals__["__file__"] = function.__code__.co_filename
    return _inlined(function)
