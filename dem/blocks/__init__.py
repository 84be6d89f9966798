"""Rigid blocks of a scene, before time discretisation."""
