"""Deformable rock by dolfinx's elements, with the joints as cohesive interfaces."""

from continuum.simulate import simulate
from continuum.validity import applies

__all__ = ["applies", "simulate"]
