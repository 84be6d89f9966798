"""Hard cases: whether both engines stay stable, each case held to a criterion from theory."""
