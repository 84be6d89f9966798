"""Implicit steps: generalised alpha in time, Newton's method, static states."""
