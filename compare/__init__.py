"""Comparison of the engines: exact solutions, misfits, experiments, figures and the report.

`jointwave` is the interface for scripts.
"""
