"""Contradictions between tables of a scene that are each valid."""
