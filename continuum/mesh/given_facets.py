"""The facets of a user's mesh of a pillar: joints, which a file has once or twice, and ends."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.gmsh_file import MeshError
from jointwave.cases.material.calibrate import Properties
from jointwave.continuum.mesh.conforming import facets_of, on_facets, row_numbers

PLACE = 1e-6  #: of the pillar's length and side: tolerance of the file's dimensions


class Halves(NamedTuple):
    """The facets of all cells, once for each cell.

    x : float array [c, f, corners, d], m. group : of the file, int array [c, f], -1 of none.
    joint : the group of joints that a facet or the one facing it is in, -1 of none. facing : number
    of facets at the same place, itself too. shared : the same for facets with the same vertices.
    """

    x: np.ndarray
    group: np.ndarray
    joint: np.ndarray
    facing: np.ndarray
    shared: np.ndarray


def grouped(kind: str, cells: np.ndarray, facets: list[np.ndarray], count: int) -> np.ndarray:
    """Return the group of each facet of each cell, int array [c, f], -1 of none.

    facets : of each group, by vertices [n, corners] below `count`. Raises MeshError.
    """
    if not facets:
        return np.full((len(cells), len(facets_of(kind))), -1)
    group = np.repeat(np.arange(len(facets)), list(map(len, facets)))
    rows, first = np.unique(np.sort(np.concatenate(facets), axis=1), axis=0, return_index=True)
    found = on_facets(kind, cells, rows, np.arange(len(rows)), count)
    lost = len(rows) - len(np.unique(found[found >= 0]))
    if lost:
        raise MeshError(f"{lost} facets of its groups belong to no rock cell")
    return np.append(group[first], -1)[found]


def halves(
    kind: str,
    x: np.ndarray,
    cells: np.ndarray,
    one: np.ndarray,
    group: np.ndarray,
    of_joints: np.ndarray,
) -> Halves:
    """Return the facets of cells [c, corners] between vertices x [v, d], m.

    one : the vertex that each counts as, int array [v]. group : of facets [c, f]. of_joints : which
    groups are of joints, the last of them none, bool array.
    """
    vertices, most = cells[:, facets_of(kind)], np.where(of_joints[group], group, -1)
    times = []
    for own in (vertices, one[vertices]):
        rows = row_numbers(np.sort(own, axis=2), len(x))
        _, number, count = np.unique(rows, return_inverse=True, return_counts=True)
        times.append(count[number.reshape(rows.shape)])
    joint = np.full(len(count), -1)
    np.maximum.at(joint, number.reshape(rows.shape), most)
    shared, facing = times
    return Halves(x[vertices], group, joint[number.reshape(rows.shape)], facing, shared)


def check_joints(found: Halves, of_joints: np.ndarray, p: Properties) -> None:
    """Raise MeshError for facets of joints without one partner, for facets at one place that are of
    no joint, where nothing would connect the rock, and for cells that overlap."""
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
            first = place(found.x[wrong][0].mean(axis=0))
            raise MeshError(f"{wrong.sum()} {fault}, the first at {first}")


def nearest_joints(found: Halves, p: Properties) -> np.ndarray:
    """Return the pillar's joint whose law each facet of a joint has, int array [c, f]: the nearest
    in y to a facet across the pillar, for all others of a group the nearest to their mean."""
    y, length = found.x[..., 1].mean(axis=2), float(p.contact_y[-1])
    inclined = np.ptp(found.x[..., 1], axis=2) > PLACE * length
    for k in np.unique(found.joint[inclined & (found.joint >= 0)]):
        own = inclined & (found.joint == k)
        y[own] = y[own].mean()
    return np.clip(np.rint(y / p.spacing).astype(np.int64) - 1, 0, p.block_count - 2)


def ends(found: Halves, names: list[str], p: Properties) -> list[np.ndarray]:
    """Return which facets are the start and the end of the pillar, bool arrays [c, f]: those of the
    groups of these names, or else those at y = 0 and y = length. Raises MeshError."""
    length, sides = float(p.contact_y[-1]), []
    for name, y in (("start", 0.0), ("end", length)):
        at = (np.abs(found.x[..., 1] - y) <= PLACE * length).all(axis=2)
        face = at & (found.facing == 1)
        chosen = found.group == names.index(name) if name in names else face
        if not chosen.any() or (chosen & ~face).any():
            raise MeshError(f"the facets of its {name} face must lie at y = {y:g} m")
        sides.append(chosen)
    return sides


def place(x: np.ndarray) -> str:
    """Return a place as text for an error message."""
    return "(" + ", ".join(f"{value:.6g}" for value in x) + ") m"
