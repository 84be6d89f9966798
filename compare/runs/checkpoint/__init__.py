"""Checkpoints, signals, and one run at a time in a folder."""
