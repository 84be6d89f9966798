"""What the scene of a rock mass calls for and hardly means."""
