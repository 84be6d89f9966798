"""Deformable rock by dolfinx's elements, with the joints as cohesive interfaces."""

from jointwave.continuum.simulate import simulate
from jointwave.continuum.validity import applies

__all__ = ["applies", "simulate"]
