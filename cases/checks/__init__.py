"""Contradictions between the tables of a scene whose tables are each right."""
