"""Scenes drawn as in a textbook: the pillar from the side, the rock mass in its plane."""
