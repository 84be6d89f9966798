"""Reflection and transmission at joints by every solver, against the angle."""
