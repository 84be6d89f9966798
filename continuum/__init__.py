"""Deformable rock in dolfinx, with the joints as cohesive interfaces."""

from continuum.reach import applies
from continuum.simulate import simulate

__all__ = ["applies", "simulate"]
