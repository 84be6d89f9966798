"""A user's own gmsh file as the mesh of a pillar: joints of any shape within it.

Groups whose names start with "rock" contain the cells, groups whose names start with "joint" the
facets of joints. Vertices at a joint may be single, or double with the facets of either side
tagged. The end faces are the groups "start" and "end", or else the facets at y = 0 and y = length.
"""

from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks, blocks_of
from jointwave.cases.geometry.cell_complex import box
from jointwave.cases.geometry.relations import merged
from jointwave.cases.gmsh_file import MeshError, Tagged, read_tagged
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.partition.pillar import SIDES
from jointwave.cases.run_memory import refuse_beyond_memory
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.mesh.conforming import (
    BOXES,
    SIMPLEX,
    SIMPLICES,
    Conforming,
    Marks,
    facets_of,
    on_facets,
    row_numbers,
)
from jointwave.continuum.mesh.size import body_bytes

PLACE = 1e-6  # tolerance of the file's dimensions, over the pillar's length and side
APART = 1e-4  # distance, over the shortest in a cell, below which vertices coincide
DIMENSION = {kind: dim for kinds in (BOXES, SIMPLICES) for dim, kind in kinds.items()}
KEY = "numerics.continuum.mesh"  #: the key of the scene


class CellFacets(NamedTuple):
    """The facets of all cells, shared ones once per cell; arrays [c, f].

    x : corners [c, f, corners, d], m. group : of the file, -1 for none. joint : group "joint..." of
    the facet or of one at the same place, -1 for none. facing : number of facets at the same place,
    itself included. shared : number of facets with the same vertices, itself included.
    """

    x: np.ndarray
    group: np.ndarray
    joint: np.ndarray
    facing: np.ndarray
    shared: np.ndarray


def mesh_of_file(
    scene: Scene, resolved: np.ndarray, dim: int | None = None
) -> tuple[Blocks, Conforming, Marks]:
    """Return the pillar of `numerics.continuum.mesh` as one block, its mesh, and the marks of its
    facets; in `Conforming.on` the numbers of the pillar's joints come first.

    resolved : numbers of the resolved joints. dim : required dimension; None for any.

    The law of a facet is that of the pillar's joint nearest in y: to the facet if it lies across
    the pillar, else to the mean of all such facets of its group. Raises SceneError if the file does
    not fit the scene.
    """
    numerics, p = scene.numerics.continuum, calibrate(scene)
    order, path = numerics.order, numerics.mesh_path
    assert path is not None
    try:
        tagged = read_tagged(path)
        kind, own = tagged.kind, DIMENSION[tagged.kind]
        if dim is not None and own != dim:
            raise MeshError(f"its rock has {kind} cells, which do not fit dim = {dim}")
        if kind in SIMPLEX and order > 2:
            raise MeshError(f"its {kind} cells support numerics.continuum.order 1 or 2")
        share = {"triangle": 0.5, "tetrahedron": 0.2}.get(kind, 1.0)  # of a box's nodes
        nodes = share * len(tagged.cells) * (order + 0.5) ** own
        refuse_beyond_memory(scene, {KEY: body_bytes(nodes, own, order, own)})
        mesh = _mesh(tagged, p)
    except MeshError as error:
        raise SceneError(scene.where, KEY, numerics.mesh, str(error)) from None
    low, high = np.full((2, own), p.side / 2) * [[-1], [1]]
    low[1], high[1] = 0.0, scene.pillar.length
    body = box(low, high)
    body.region[:] = 0
    column = np.full(p.block_count + 2, -1)
    column[resolved] = resolved
    side = np.append(np.full(p.block_count - 1, -1), [0, 1, 2])
    return blocks_of(body, PLACE * p.side, in_rows=False), mesh, Marks(column, side, SIDES)


def _mesh(tagged: Tagged, p: Properties) -> Conforming:
    """Return the mesh of a file, with cells in the order of y."""
    kind, names = tagged.kind, sorted(tagged.facets)
    used, cells = np.unique(tagged.cells, return_inverse=True)
    x, cells = tagged.x[used], cells.reshape(tagged.cells.shape)
    _check_extent(x, p, DIMENSION[kind])
    x = x[:, : DIMENSION[kind]]
    cells = _oriented(kind, x, cells)
    cells = cells[np.argsort(x[cells, 1].mean(axis=1), kind="stable")]
    i, j = np.triu_indices(cells.shape[1], 1)
    shortest = float(np.linalg.norm(x[cells[:, i]] - x[cells[:, j]], axis=2).min())
    one, index = merged(x, APART * shortest), np.full(len(tagged.x), len(x))
    index[used] = np.arange(len(x))
    group = _grouped(kind, cells, [index[tagged.facets[name]] for name in names], len(x) + 1)
    of_joints = np.array([*(name.startswith("joint") for name in names), False])
    found = _facets(kind, x, cells, one, group, of_joints)
    _check_joints(found, of_joints, p)
    on = np.where(found.joint >= 0, _nearest_joints(found, p), -1)
    on[(found.facing == 1) & (found.joint < 0)] = p.block_count + 1
    for k, (name, y) in enumerate((("start", 0.0), ("end", float(p.contact_y[-1])))):
        at = (np.abs(found.x[..., 1] - y) <= PLACE * p.contact_y[-1]).all(axis=2)
        face = at & (found.facing == 1)
        chosen = found.group == names.index(name) if name in names else face
        if not chosen.any() or (chosen & ~face).any():
            raise MeshError(f"the facets of its {name} face must lie at y = {y:g} m")
        on[chosen] = p.block_count - 1 + k
    at_joint = np.zeros(len(x), bool)  # merge double vertices at joints only
    at_joint[one[cells[:, facets_of(kind)][found.joint >= 0]]] = True
    vertex = np.where(at_joint[one], one, np.arange(len(x)))
    used, numbers = np.unique(vertex[cells], return_inverse=True)
    return Conforming(kind, x[used], numbers.reshape(cells.shape), np.zeros(len(on), np.int64), on)


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
    """Return cells with positive Jacobians, mirrored ones renumbered. Raises MeshError."""
    corner = np.arange(cells.shape[1])
    if kind in SIMPLEX:
        turned = np.append(corner[:-2], corner[:-3:-1])
    else:  # the first two axes exchanged
        turned = corner & ~3 | (corner & 1) << 1 | (corner & 2) >> 1
    mirrored = (_jacobians(kind, x[cells]) < 0).all(axis=1)
    cells = np.where(mirrored[:, None], cells[:, turned], cells)
    bad = (_jacobians(kind, x[cells]) <= 0).any(axis=1)
    if bad.any():
        at = _place(x[cells[bad.argmax()]].mean(axis=0))
        raise MeshError(f"{bad.sum()} of its cells are flat or inside out, the first at {at}")
    return cells


def _jacobians(kind: str, x: np.ndarray) -> np.ndarray:
    """Return the Jacobian determinants at the corners of cells [c, n], m^d (of a simplex only one);
    x : corners [c, corners, d], m."""
    if kind in SIMPLEX:
        return np.linalg.det(x[:, 1:] - x[:, :1])[:, None]
    corner, bit = np.arange(x.shape[1])[:, None], 1 << np.arange(x.shape[2])
    return np.linalg.det(x[:, corner | bit] - x[:, corner & ~bit])


def _grouped(kind: str, cells: np.ndarray, facets: list[np.ndarray], count: int) -> np.ndarray:
    """Return the group of each facet of each cell [c, f], -1 for none.

    facets : of each group, vertices [n, corners] below `count`. Raises MeshError.
    """
    if not facets:
        return np.full((len(cells), len(facets_of(kind))), -1)
    group = np.repeat(np.arange(len(facets)), list(map(len, facets)))
    rows, first = np.unique(np.sort(np.concatenate(facets), axis=1), axis=0, return_index=True)
    found = on_facets(kind, cells, rows, np.arange(len(rows)), count)
    if lost := len(rows) - len(np.unique(found[found >= 0])):
        raise MeshError(f"{lost} facets of its groups belong to no rock cell")
    return np.append(group[first], -1)[found]


def _facets(
    kind: str,
    x: np.ndarray,
    cells: np.ndarray,
    one: np.ndarray,
    group: np.ndarray,
    of_joints: np.ndarray,
) -> CellFacets:
    """Return the facets of cells [c, corners] between vertices x [v, d], m.

    one : representative of the coincident vertices of each vertex [v]. group : of facets [c, f].
    of_joints : whether each group is of joints, with False at the end for no group.
    """
    vertices, times = cells[:, facets_of(kind)], []
    for own in (vertices, one[vertices]):
        rows = row_numbers(np.sort(own, axis=2), len(x))
        _, number, count = np.unique(rows, return_inverse=True, return_counts=True)
        number = number.reshape(rows.shape)
        times.append(count[number])
    joint, (shared, facing) = np.full(len(count), -1), times
    np.maximum.at(joint, number, np.where(of_joints[group], group, -1))
    return CellFacets(x[vertices], group, joint[number], facing, shared)


def _check_joints(found: CellFacets, of_joints: np.ndarray, p: Properties) -> None:
    """Raise MeshError for facets of joints without exactly one partner, for coincident facets in no
    joint, which nothing would connect, and for cells that overlap."""
    if found.shared.max() > 2:
        raise MeshError("some of its cells overlap: more than two share one facet")
    tagged = of_joints[found.group]
    alone, loose = tagged & (found.facing == 1), found.facing > found.shared
    length, dim = float(p.contact_y[-1]), found.x.shape[-1]
    middle, half = np.zeros(dim), np.full(dim, p.side / 2)
    middle[1] = half[1] = length / 2
    on_side = np.abs(np.abs(found.x - middle) - half) <= PLACE * length
    outside = alone & on_side.all(axis=2).any(axis=2)
    for wrong, fault in (
        (outside, "facets of its joints lie on the boundary of the pillar"),
        (alone, "facets of its joints have no coincident partner"),
        (tagged & (found.facing > 2), "facets of its joints have more than one partner"),
        (loose & (found.joint < 0), "facets coincide with others and are in no group 'joint...'"),
    ):
        if wrong.any():
            first = _place(found.x[wrong][0].mean(axis=0))
            raise MeshError(f"{wrong.sum()} {fault}, the first at {first}")


def _nearest_joints(found: CellFacets, p: Properties) -> np.ndarray:
    """Return the pillar's joint that gives each facet of a joint its law [c, f]: the nearest in y
    to a facet across the pillar, for the others of a group the nearest to their mean."""
    y, length = found.x[..., 1].mean(axis=2), float(p.contact_y[-1])
    inclined = np.ptp(found.x[..., 1], axis=2) > PLACE * length
    for k in np.unique(found.joint[inclined & (found.joint >= 0)]):
        own = inclined & (found.joint == k)
        y[own] = y[own].mean()
    return np.clip(np.rint(y / p.spacing).astype(np.int64) - 1, 0, p.block_count - 2)


def _place(x: np.ndarray) -> str:
    """Return a place as text for an error message."""
    return "(" + ", ".join(f"{value:.6g}" for value in x) + ") m"
