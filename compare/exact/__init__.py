"""Exact solutions, one file each: formula, source, validity, `applies(scene)`, `solve(scene)`."""
