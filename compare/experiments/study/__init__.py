"""Studies: one scene solved in many ways, each with its error and its cost, as one table."""
