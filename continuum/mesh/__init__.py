"""Meshes of a scene or a gmsh file: vertices, cells, and the facet pairs of joints.

Plain numpy: nothing here knows dolfinx, and gmsh and meshio are imported where they are called.
"""
