"""Compilation, array alignment, time loop and divergence monitor, shared by all kernels."""
