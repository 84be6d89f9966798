"""From a scene, or a gmsh file, to vertices, cells and the facet pairs that joints hold together.

Plain numpy: nothing here knows dolfinx, and gmsh and meshio are imported where they are called.
"""
