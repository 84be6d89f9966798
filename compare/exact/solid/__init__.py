"""Elastic bodies in two or three dimensions: beam, column, manufactured motion."""
