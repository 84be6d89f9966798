"""Geometry in one, two or three dimensions: a domain cut by planes into convex blocks.

Inputs are arrays and plain records of domains, plane sets, regions and openings, not scenes.
"""
