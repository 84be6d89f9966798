"""The engines as entries of the registry, and the record that every solver has there."""
