"""Studies over many runs: each is one table, one diagram, and points that are saved."""
