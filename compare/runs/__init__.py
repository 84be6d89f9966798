"""Execution of runs: jobs, processes, checkpoints and files."""
