"""Exact solutions of whole rock masses: which scenes they hold for, and their results."""
