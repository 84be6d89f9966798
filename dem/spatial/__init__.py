"""Blocks that translate and rotate in space, stepped 64 at a time."""
