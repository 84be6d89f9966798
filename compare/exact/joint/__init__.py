"""One joint, or parallel joints, between two half-spaces of rock."""
