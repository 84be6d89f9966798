"""Explicit steps of a body that several processes share."""
