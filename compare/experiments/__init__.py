"""Experiments over many runs: effects of scenes, and waves at joints."""
