"""Leapfrog steps, compiled, and their critical step."""
