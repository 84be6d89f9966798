"""The pillar's rock mass as a gmsh mesh: a bar of segments, or a column of cubes."""

from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np

#: Corners of a hexahedron in gmsh's order, in steps along x, y, z.
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


class Mesh(NamedTuple):
    """Nodes [n, 3] (m) with the axis along x, and elements [m, corners], numbered from 0.

    kind : gmsh's number of the element. loaded, share : nodes of the start face, and the area
    that each stands for (m2; 1 for a bar, whose section gmsh does not know).
    """

    kind: int
    nodes: np.ndarray
    elements: np.ndarray
    loaded: np.ndarray
    share: np.ndarray


def bar(length: float, count: int) -> Mesh:
    """Return a bar of so many segments."""
    nodes = np.zeros((count + 1, 3))
    nodes[:, 0] = length / count * np.arange(count + 1)
    elements = np.arange(count)[:, None] + np.arange(2)
    return Mesh(1, nodes, elements, np.zeros(1, dtype=int), np.ones(1))


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
    return Mesh(5, nodes, elements, np.arange(width * width), share)


def write(path: Path, mesh: Mesh) -> None:
    """Write a mesh as gmsh's format 2.2, all elements in one group."""
    nodes = "".join(
        f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(mesh.nodes.tolist(), 1)
    )
    elements = "".join(
        f"{i} {mesh.kind} 2 1 1 {' '.join(str(n + 1) for n in element)}\n"
        for i, element in enumerate(mesh.elements.tolist(), 1)
    )
    path.write_text(
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(mesh.nodes)}\n{nodes}$EndNodes\n"
        f"$Elements\n{len(mesh.elements)}\n{elements}$EndElements\n"
    )
