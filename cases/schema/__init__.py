"""The scene vocabulary: tables and keys of a scene file, their types and consistency."""
