"""Formulas that are plain Python, and that numba compiles into the kernels that call them."""

from numba.extending import register_jitable

formula = register_jitable(forceinline=True, error_model="numpy")
