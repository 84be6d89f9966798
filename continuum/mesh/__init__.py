"""Meshes of a scene or a gmsh file: vertices, cells, and the facet pairs of joints.

Plain numpy: no module here uses dolfinx, and gmsh and meshio are imported where they are called.
"""
