"""Models of a scene file: its tables and keys, their types and consistency."""
