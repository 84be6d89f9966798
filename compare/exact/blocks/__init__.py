"""Rows of rigid blocks, exact in time."""
