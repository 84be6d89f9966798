"""A user's own gmsh file as a mesh: any shape of joints inside the pillar of the scene.

The physical groups of the file identify its parts: groups whose names start with "rock" contain the
cells, groups whose names start with "joint" the facets of joints. At a joint the vertices may exist
twice, with the facets of either side tagged, or once: then the rock is cut there. The end faces are
the groups "start" and "end", or else the facets at y = 0 and y = length.
"""

from pathlib import Path

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.gmsh_file import MeshError, Tagged, read_tagged
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.mesh import facets
from jointwave.continuum.mesh.cells import DIMENSION, FACETS, jacobians, oriented
from jointwave.continuum.mesh.cut import pieces, split
from jointwave.continuum.mesh.description import Mesh, Part, Side
from jointwave.continuum.mesh.facets import Facets
from jointwave.continuum.mesh.paired import paired_joints, place

PLACE = 1e-6  #: of the pillar's length and side: tolerance of the file's dimensions


def given_mesh(path: str | Path, scene: Scene, p: Properties, dim: int | None = None) -> Mesh:
    """Return the mesh of a gmsh file, in two or three dimensions unless `dim` is given.

    The law of a joint facet is that of the pillar's joint nearest in y: nearest to the facet itself
    if it lies across the pillar, nearest to the group's mean for all other facets of a group.
    Raises SceneError if the mesh does not fit the scene.
    """
    key, given = "numerics.continuum.mesh", scene.numerics.continuum.mesh or str(path)
    try:
        tagged = read_tagged(path)
        _check_kind(scene, tagged.kind, dim)
        return _mesh(tagged, p)
    except MeshError as error:
        raise SceneError(scene.where, key, given, str(error)) from None


def _check_kind(scene: Scene, kind: str, dim: int | None) -> None:
    numerics, simplices = scene.numerics.continuum, kind in ("triangle", "tetrahedron")
    if dim is not None and DIMENSION[kind] != dim:
        raise MeshError(f"its rock has {kind} cells, which do not fit dim = {dim}")
    if simplices and numerics.order > 2:
        raise MeshError(f"its {kind} cells support numerics.continuum.order 1 or 2")
    if not simplices and numerics.mass == "consistent":
        raise MeshError(f"its {kind} cells support numerics.continuum.mass = 'lumped' only")


def _mesh(tagged: Tagged, p: Properties) -> Mesh:
    kind, dim = tagged.kind, DIMENSION[tagged.kind]
    used, cells = np.unique(tagged.cells, return_inverse=True)
    x, cells = tagged.x[used], cells.reshape(tagged.cells.shape)
    _check_extent(x, p, dim)
    x = x[:, :dim]
    cells = oriented(kind, x, cells)
    _check_cells(kind, x, cells)
    names = sorted(tagged.facets)
    group = _group_of_facets(kind, used[cells], [tagged.facets[name] for name in names])
    is_joint = np.array([False, *(name.startswith("joint") for name in names)])
    x, cells = split(kind, x, cells, is_joint[group])
    piece = pieces(cells)
    order = _along_pillar(x, cells, piece)
    cells, piece, group = cells[order], piece[order], group[order]
    whole = Part(x, cells, np.zeros(len(cells), dtype=np.int64), np.zeros((1, dim)))
    alone = facets.outer(kind, cells)
    outer, group = facets.on_copies(kind, whole, *alone), group[alone]
    joints = paired_joints(outer, np.where(is_joint[group], group, 0), p)
    return Mesh(kind, _parts(whole, piece), (), joints, _ends(outer, group, names, p))


def _check_extent(x: np.ndarray, p: Properties, dim: int) -> None:
    half, length = p.side / 2, p.spacing * p.block_count
    wanted = {"x": (-half, half), "y": (0, length), "z": (-half, half) if dim == 3 else (0, 0)}
    for (axis, (low, high)), values in zip(wanted.items(), x.T, strict=True):
        exact = PLACE * (length if axis == "y" else p.side)
        if abs(values.min() - low) > exact or abs(values.max() - high) > exact:
            raise MeshError(
                f"its rock spans {axis} = {values.min():.7g} to {values.max():.7g} m, the pillar "
                f"{low:g} to {high:g} m"
            )


def _check_cells(kind: str, x: np.ndarray, cells: np.ndarray) -> None:
    bad = (jacobians(kind, x, cells) <= 0).any(axis=1)
    if bad.any():
        first = x[cells[bad.argmax()]].mean(axis=0)
        raise MeshError(
            f"{bad.sum()} of its cells are flat or inside out, the first at {place(first)}"
        )
    if np.bincount(facets.facet_numbers(kind, cells)).max() > 2:
        raise MeshError("some of its cells overlap: more than two share one facet")


def _group_of_facets(kind: str, cells: np.ndarray, groups: list[np.ndarray]) -> np.ndarray:
    """Return the group of each facet of each cell [cells, facets]: 0 none, k the k-th."""
    table = FACETS[kind]
    rows = [cells[:, table].reshape(-1, table.shape[1]), *groups]
    number = facets.row_numbers(np.sort(np.concatenate(rows), axis=1))
    of_cells, of_groups = np.split(number, [cells.shape[0] * len(table)])
    lost = ~np.isin(of_groups, of_cells)
    if lost.any():
        raise MeshError(f"{lost.sum()} facets of its groups belong to no rock cell")
    group = np.zeros(number.max() + 1, dtype=np.int64)
    group[of_groups] = np.repeat(1 + np.arange(len(groups)), [len(rows) for rows in groups])
    return group[of_cells].reshape(len(cells), len(table))


def _along_pillar(x: np.ndarray, cells: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """Return the order of cells by piece, with pieces sorted by their start along y, int array."""
    begin = np.full(piece.max() + 1, np.inf)
    np.minimum.at(begin, piece, x[cells, 1].min(axis=1))
    return np.lexsort((piece, begin[piece]))


def _parts(whole: Part, piece: np.ndarray) -> tuple[Part, ...]:
    """Return the pieces of the whole mesh, whose cells are sorted by piece."""
    parts = []
    for cells in np.split(whole.cells, np.flatnonzero(np.diff(piece)) + 1):
        used, number = np.unique(cells, return_inverse=True)
        material = np.zeros(len(cells), dtype=np.int64)
        parts.append(Part(whole.x[used], number.reshape(cells.shape), material, whole.shifts))
    return tuple(parts)


def _ends(outer: Facets, group: np.ndarray, names: list[str], p: Properties) -> dict[str, Side]:
    """Return the facets of the end faces, from the groups or else by their position."""
    length, sides = p.spacing * p.block_count, {}
    for name, y in (("start", 0.0), ("end", length)):
        face = facets.lies_at(outer, y, PLACE * length)
        chosen = group == 1 + names.index(name) if name in names else face
        if not chosen.any() or (chosen & ~face).any():
            raise MeshError(f"the facets of its {name} face must lie at y = {y:g} m")
        sides[name] = outer.side(chosen)
    return sides
