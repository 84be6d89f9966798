"""Blocks that translate and turn in space, stepped 64 at a time."""
