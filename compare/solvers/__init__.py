"""The engines' entries in the registry, and the record type of all its solvers."""
