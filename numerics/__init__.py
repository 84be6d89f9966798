"""Compilation, array alignment, checkpoints and divergence monitoring, shared by all kernels."""
