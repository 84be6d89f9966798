"""Formulas that are plain Python, and that numba compiles into the kernels that call them."""

from numba.extending import register_jitable

#: Python can call a formula; in a kernel its code is inlined, with IEEE arithmetic.
formula = register_jitable(forceinline=True, error_model="numpy")
