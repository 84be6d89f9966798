"""Meshes of blocks, from the cell complex of a scene or from a file."""
