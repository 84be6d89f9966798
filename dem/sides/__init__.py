"""Loads and boundaries of rigid blocks: sides, ends, forces, waves and moving bases."""
