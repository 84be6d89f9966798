"""Sweeps: one scene run or compared at every value of some keys, each in a folder, as one table."""
