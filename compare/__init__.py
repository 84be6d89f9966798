"""Comparison of the engines: exact solutions, misfits, experiments, figures and the report.

Scripts import `jointwave`.
"""
