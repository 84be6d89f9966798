"""Passes by which numba compiles formulas and kernels, for versions whose internals they fit."""
