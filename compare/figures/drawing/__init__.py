"""The drawing of a scene: the pillar from the side, its section, its load."""
