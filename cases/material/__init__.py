"""Calibration: stiffness, damping and strength of every joint, and the inertia of blocks."""
