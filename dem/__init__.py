"""Rigid blocks joined by springs and dashpots: the model of Guo & Li (2002)."""

from jointwave.dem.simulate import simulate

__all__ = ["simulate"]
