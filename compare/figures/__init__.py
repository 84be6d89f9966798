"""Figures of scenes and results, for print and for the screen."""
