"""Explicit steps of a body by several processes."""
