"""A mesh as a gmsh file that reads back as the same mesh, for users who go on from there."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from continuum.mesh.cells import DIMENSION, FACETS, FROM_GMSH
from continuum.mesh.description import Mesh, Part, Side
from continuum.mesh.tagged import FACET_NAMES, KINDS


class Group(NamedTuple):
    """A named group of a gmsh file: meshio's name of its cells, their dimension, their vertices."""

    name: str
    cell: str
    dim: int
    vertices: np.ndarray


def export(mesh: Mesh, path: str | Path) -> None:
    """Write a mesh of two or three dimensions with all its copies as a gmsh file, version 2.2.

    Its groups are "rock", "layer 7" for the pillar's joint 7 meshed as a layer, "joint 7" with the
    facets of both sides, "start" and "end". Without layers it reads back by `given_mesh`.
    """
    import meshio

    whole = whole_part(mesh)
    groups = [*_rock(mesh, whole), *_facets(mesh, whole)]
    tags = [np.full(len(group.vertices), 1 + k) for k, group in enumerate(groups)]
    names = {group.name: np.array([1 + k, group.dim]) for k, group in enumerate(groups)}
    file = meshio.Mesh(
        np.pad(whole.x, ((0, 0), (0, 3 - whole.x.shape[1]))),
        [(group.cell, group.vertices) for group in groups],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=names,
    )
    meshio.write(path, file, "gmsh22")


def whole_part(mesh: Mesh) -> Part:
    """Return all copies of all parts as one part that stands once, cells numbered as in `Side`."""
    x, cells, material, first = [], [], [], 0
    for part in mesh.parts:
        x.append((part.shifts[:, None] + part.x).reshape(-1, part.x.shape[1]))
        copy = first + len(part.x) * np.arange(part.copies)
        cells.append((copy[:, None, None] + part.cells).reshape(-1, part.cells.shape[1]))
        material.append(np.tile(part.material, part.copies))
        first += len(x[-1])
    once = np.zeros((1, x[0].shape[1]))
    return Part(np.concatenate(x), np.concatenate(cells), np.concatenate(material), once)


def _rock(mesh: Mesh, whole: Part) -> Iterator[Group]:
    name = next(name for name, kind in KINDS.items() if kind == mesh.cell)
    cells = whole.cells[:, np.argsort(FROM_GMSH[mesh.cell])]
    for k in np.unique(whole.material):
        group = f"layer {mesh.layers[k - 1]}" if k else "rock"
        yield Group(group, name, DIMENSION[mesh.cell], cells[whole.material == k])


def _facets(mesh: Mesh, whole: Part) -> Iterator[Group]:
    both = np.tile(mesh.joints.joint, 2)
    sides = {
        f"joint {joint}": _both_sides(mesh, both == joint) for joint in np.unique(mesh.joints.joint)
    }
    name, dim = FACET_NAMES[mesh.cell], DIMENSION[mesh.cell] - 1
    for group, side in {**sides, "start": mesh.start, "end": mesh.end}.items():
        vertices = _vertices(mesh.cell, whole, side)
        if name == "quad":
            vertices = vertices[:, FROM_GMSH["quadrilateral"]]
        yield Group(group, name, dim, vertices)


def _both_sides(mesh: Mesh, chosen: np.ndarray) -> Side:
    joints = mesh.joints
    cell = np.concatenate([joints.left, joints.right])
    return Side(cell[chosen], np.tile(joints.corners, (2, 1, 1))[chosen])


def _vertices(kind: str, whole: Part, side: Side) -> np.ndarray:
    """Return the vertices of the cells' facets at the places of a side [facets, facet corners]."""
    candidates = whole.cells[side.cell][:, FACETS[kind]]
    middle, wanted = whole.x[candidates].mean(axis=2), side.corners.mean(axis=1)
    nearest = np.linalg.norm(middle - wanted[:, None], axis=-1).argmin(axis=1)
    return np.take_along_axis(candidates, nearest[:, None, None], axis=1)[:, 0]
