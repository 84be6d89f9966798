"""Deformable rock in dolfinx, with the joints as cohesive interfaces."""

from continuum.simulate import applies, simulate

__all__ = ["applies", "simulate"]
