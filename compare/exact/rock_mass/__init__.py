"""Exact solutions of whole rock masses: conditions and results."""
