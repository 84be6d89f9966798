"""Explicit and implicit steps of a body, and its static states."""
