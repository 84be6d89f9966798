"""Exact solutions, a file each: formula, source, validity, `applies(scene)`, `solve(scene)`."""
