"""Rigid blocks joined by springs and dashpots: the model of Guo & Li (2002)."""

from jointwave.dem.run import plan, simulate

__all__ = ["plan", "simulate"]
