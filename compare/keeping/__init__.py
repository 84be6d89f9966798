"""Runs that lose nothing: checkpoints, signals, and one run at a time in a folder."""
