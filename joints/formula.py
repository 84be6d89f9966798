"""The decorator of formulas: plain Python functions that numba compiles into its kernels."""

from numba.extending import register_jitable

#: Python can call a formula; in a kernel its code is inlined, with IEEE arithmetic. Compiled code
#: is called from kernels only, so it has no wrappers.
formula = register_jitable(
    forceinline=True, error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=True
)
