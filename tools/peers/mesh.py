"""The pillar's rock mass as a gmsh mesh: a bar of segments, or a column of cubes."""

from itertools import product
from pathlib import Path
from typing import NamedTuple

import meshio
import numpy as np

#: Corners of a hexahedron in gmsh's order, in steps along x, y, z.
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


class Mesh(NamedTuple):
    """Nodes [n, 3], m, with the axis along x, and elements [m, corners], numbered from 0.

    kind : of the element, meshio's name. loaded, share : nodes of the start face, and their areas,
    m2 (1 for a bar, whose section gmsh does not know).
    """

    kind: str
    nodes: np.ndarray
    elements: np.ndarray
    loaded: np.ndarray
    share: np.ndarray


def bar(length: float, count: int) -> Mesh:
    """Return a bar of `count` segments."""
    nodes = np.zeros((count + 1, 3))
    nodes[:, 0] = length / count * np.arange(count + 1)
    elements = np.arange(count)[:, None] + np.arange(2)
    return Mesh("line", nodes, elements, np.zeros(1, dtype=int), np.ones(1))


def column(length: float, side: float, count: int, across: int) -> Mesh:
    """Return a square column of count x across x across bricks, layer after layer."""
    steps = np.arange(across + 1)
    at = np.array(list(product(np.arange(count + 1), steps, steps)))
    nodes = at * [length / count, side / across, side / across]
    width = across + 1
    first = np.array(list(product(range(count), range(across), range(across))))
    corners = first[:, None, :] + np.array(CORNERS)
    elements = corners @ [width * width, width, 1]
    ends = np.where((steps == 0) | (steps == across), 0.5, 1.0)
    share = np.outer(ends, ends).ravel() * (side / across) ** 2
    return Mesh("hexahedron", nodes, elements, np.arange(width * width), share)


def write(path: Path, mesh: Mesh) -> None:
    """Write a mesh as gmsh's format 2.2, all elements in one group."""
    group = [np.ones(len(mesh.elements), dtype=int)]
    tags = {"gmsh:physical": group, "gmsh:geometrical": group}
    cells = [(mesh.kind, mesh.elements)]
    written = meshio.Mesh(mesh.nodes, cells, cell_data=tags)
    meshio.write(path, written, file_format="gmsh22", binary=False)
