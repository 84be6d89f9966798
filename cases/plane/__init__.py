"""Effects and warnings of the scene of a rock mass."""
