"""Exact solutions of whole rock masses: their conditions and results."""
