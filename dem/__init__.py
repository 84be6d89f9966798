"""Rigid blocks joined by springs and dashpots: the model of Guo & Li (2002)."""

from dem.simulate import simulate, simulate_fields

__all__ = ["simulate", "simulate_fields"]
