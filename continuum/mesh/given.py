"""A user's own gmsh file as the mesh of a pillar: joints of any shape within it.

Groups whose names start with "rock" hold the cells, groups whose names start with "joint" the
facets of joints. At a joint the file may have vertices once, or twice with the facets of either
side tagged. The end faces are the groups "start" and "end", or else the facets at y = 0 and y =
length.
"""

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks, blocks_of
from jointwave.cases.geometry.cell_complex import box
from jointwave.cases.geometry.relations import joined, merged
from jointwave.cases.gmsh_file import MeshError, Tagged, read_tagged
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.run_memory import refuse_beyond_memory
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.mesh.conforming import (
    BOXES,
    SIMPLICES,
    Conforming,
    facets_of,
    shared,
)
from jointwave.continuum.mesh.domain import Marks
from jointwave.continuum.mesh.given_facets import (
    PLACE,
    check_joints,
    ends,
    grouped,
    halves,
    nearest_joints,
    place,
)
from jointwave.continuum.mesh.size import body_bytes

APART = 1e-4  # of the shortest distance in a cell: vertices of two sides of a joint that are one
DIMENSION = {kind: dim for kinds in (BOXES, SIMPLICES) for dim, kind in kinds.items()}
ENDS = ("start", "end", "along")  #: sides of a pillar: its ends, and those along it
KEY = "numerics.continuum.mesh"  #: the key of the scene


def mesh_of_file(
    scene: Scene, resolved: np.ndarray, dim: int | None = None
) -> tuple[Blocks, Conforming, Marks]:
    """Return the pillar of `numerics.continuum.mesh` as one block, its mesh, and the marks of its
    facets: of `Conforming.on` joints come first, by their number in the pillar.

    resolved : which joints are, int array. dim : that the mesh must have; None for any.

    The law of a facet is that of the pillar's joint nearest in y: nearest to the facet itself if it
    lies across the pillar, nearest to the group's mean for all other facets of a group. Raises
    SceneError where the file does not fit the scene.
    """
    numerics, p = scene.numerics.continuum, calibrate(scene)
    path = numerics.mesh_path
    assert path is not None
    try:
        tagged = read_tagged(path)
        _check_kind(scene, tagged.kind, dim)
        _refuse_large(scene, tagged)
        mesh = _mesh(tagged, p)
    except MeshError as error:
        raise SceneError(scene.where, KEY, numerics.mesh, str(error)) from None
    joint = np.arange(p.block_count - 1)
    none = np.full(len(joint), -1)
    column = np.append(np.where(np.isin(joint, resolved), joint, -1), [-1, -1, -1])
    return _whole(scene, mesh.x.shape[1]), mesh, Marks(column, np.append(none, [0, 1, 2]), ENDS)


def _check_kind(scene: Scene, kind: str, dim: int | None) -> None:
    numerics, simplices = scene.numerics.continuum, kind in SIMPLICES.values()
    if dim is not None and DIMENSION[kind] != dim:
        raise MeshError(f"its rock has {kind} cells, which do not fit dim = {dim}")
    if simplices and numerics.order > 2:
        raise MeshError(f"its {kind} cells support numerics.continuum.order 1 or 2")
    if not simplices and numerics.mass == "consistent":
        raise MeshError(f"its {kind} cells support numerics.continuum.mass = 'lumped' only")


def _refuse_large(scene: Scene, tagged: Tagged) -> None:
    """Raise SceneError where the body of a mesh would not fit in memory."""
    order, dim = scene.numerics.continuum.order, DIMENSION[tagged.kind]
    share = 1.0 if tagged.kind in BOXES.values() else {2: 0.5, 3: 0.2}[dim]
    nodes = share * len(tagged.cells) * (order + 0.5) ** dim
    refuse_beyond_memory(scene, {KEY: body_bytes(nodes, dim, order, dim)})


def _whole(scene: Scene, dim: int) -> Blocks:
    """Return a pillar as one block."""
    low, high = np.full((2, dim), scene.pillar.side / 2) * [[-1], [1]]
    low[1], high[1] = 0.0, scene.pillar.length
    body = box(low, high)
    body.region[:] = 0
    return blocks_of(body, PLACE * scene.pillar.side, in_rows=False)


def _mesh(tagged: Tagged, p: Properties) -> Conforming:
    kind, dim = tagged.kind, DIMENSION[tagged.kind]
    used, cells = np.unique(tagged.cells, return_inverse=True)
    x, cells = tagged.x[used], cells.reshape(tagged.cells.shape)
    _check_extent(x, p, dim)
    x = x[:, :dim]
    cells = _oriented(kind, x, cells)
    i, j = np.triu_indices(cells.shape[1], 1)
    shortest = float(np.linalg.norm(x[cells[:, i]] - x[cells[:, j]], axis=2).min())
    one = merged(x, APART * shortest)
    index, names = np.full(len(tagged.x), len(x)), sorted(tagged.facets)
    index[used] = np.arange(len(x))
    group = grouped(kind, cells, [index[tagged.facets[name]] for name in names], len(x) + 1)
    of_joints = np.array([*(name.startswith("joint") for name in names), False])
    found = halves(kind, x, cells, one, group, of_joints)
    check_joints(found, of_joints, p)
    on = np.where(found.joint >= 0, nearest_joints(found, p), -1)
    on[(found.facing == 1) & (found.joint < 0)] = p.block_count + 1
    for k, side in enumerate(ends(found, names, p)):
        on[side] = p.block_count - 1 + k
    at_joint = np.zeros(len(x), bool)  # rock may touch other rock in a vertex that it has twice
    at_joint[one[cells[:, facets_of(kind)][found.joint >= 0]]] = True
    vertex = np.where(at_joint[one], one, np.arange(len(x)))
    used, cells = np.unique(vertex[cells], return_inverse=True)
    block = np.zeros(len(on), np.int64)
    mesh = Conforming(kind, x[used], cells.reshape(len(on), -1), block, on)
    return _along(mesh, found.joint >= 0)


def _check_extent(x: np.ndarray, p: Properties, dim: int) -> None:
    half, length = p.side / 2, float(p.contact_y[-1])
    wanted = {"x": (-half, half), "y": (0, length), "z": (-half, half) if dim == 3 else (0, 0)}
    for (axis, (low, high)), values in zip(wanted.items(), x.T, strict=True):
        exact = PLACE * (length if axis == "y" else p.side)
        if abs(values.min() - low) > exact or abs(values.max() - high) > exact:
            raise MeshError(
                f"its rock spans {axis} = {values.min():.7g} to {values.max():.7g} m, the pillar "
                f"{low:g} to {high:g} m"
            )


def _oriented(kind: str, x: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return cells with positive Jacobians: mirrored ones are turned. Raises MeshError."""
    corner = np.arange(cells.shape[1])
    if kind in SIMPLICES.values():
        turned = np.append(corner[:-2], corner[:-3:-1])
    else:  # the first two axes exchanged
        turned = corner & ~3 | (corner & 1) << 1 | (corner & 2) >> 1
    mirrored = (_jacobians(kind, x[cells]) < 0).all(axis=1)
    cells = np.where(mirrored[:, None], cells[:, turned], cells)
    bad = (_jacobians(kind, x[cells]) <= 0).any(axis=1)
    if bad.any():
        at = place(x[cells[bad.argmax()]].mean(axis=0))
        raise MeshError(f"{bad.sum()} of its cells are flat or inside out, the first at {at}")
    return cells


def _jacobians(kind: str, x: np.ndarray) -> np.ndarray:
    """Return the determinants of the Jacobians at the corners [c, n] of cells, m^d; of a simplex
    one. x : of their corners [c, corners, d], m."""
    if kind in SIMPLICES.values():
        return np.linalg.det(x[:, 1:] - x[:, :1])[:, None]
    corner, bit = np.arange(x.shape[1])[:, None], 1 << np.arange(x.shape[2])
    return np.linalg.det(x[:, corner | bit] - x[:, corner & ~bit])


def _along(mesh: Conforming, is_joint: np.ndarray) -> Conforming:
    """Return a mesh with its cells in order along the pillar, piece by piece of rock: the first of
    two beside a joint is the one towards y = 0."""
    pairs, y = shared(mesh), mesh.x[mesh.cells, 1]
    uncut = ~is_joint[pairs.cell, pairs.facet].any(axis=1)
    piece = joined(pairs.cell[uncut], len(y))
    begin = np.full(piece.max() + 1, np.inf)
    np.minimum.at(begin, piece, y.min(axis=1))
    order = np.lexsort((y.mean(axis=1), piece, begin[piece]))
    return mesh._replace(cells=mesh.cells[order], on=mesh.on[order])
