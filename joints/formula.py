"""Formulas that are plain Python, and that numba compiles into the kernels that call them."""

from numba.extending import register_jitable

#: Python can call a formula; in a kernel its code is inlined, with IEEE arithmetic. Nothing else
#: calls what is compiled: it has no wrappers.
formula = register_jitable(
    forceinline=True, error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=True
)
