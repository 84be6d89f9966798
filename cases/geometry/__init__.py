"""Geometry of a scene in one, two or three dimensions: a domain cut by planes into convex blocks.

Knows nothing of scenes and their files: domains, sets of planes, regions and openings are arrays
and plain records here.
"""
