"""The joints of a user's mesh: facet pairs, and the pillar's joint whose law they follow."""

import numpy as np

from jointwave.cases.gmsh_file import MeshError
from jointwave.cases.material.calibrate import Properties
from jointwave.continuum.mesh import facets
from jointwave.continuum.mesh.description import Joints
from jointwave.continuum.mesh.facets import Facets

ACROSS = 1e-6  #: of the pillar's length: tolerance for a facet to lie across it


def paired_joints(outer: Facets, group: np.ndarray, p: Properties) -> Joints:
    """Return the joints among the outer facets of a mesh.

    `group` (int array [facets]) is the group of each joint facet, 0 for none. Raises MeshError for
    a joint facet without exactly one partner at the same place in another cell, and for a pair of
    untagged facets, where nothing would connect the rock.
    """
    pair = facets.pairs(outer)
    partners = np.bincount(pair.ravel(), minlength=len(group))
    of_pair = group[pair].max(axis=1, initial=0)
    alone = (group > 0) & (partners == 0)
    outside = alone & _on_outside(outer, p)
    _refuse(outer, outside, "facets of its joints lie on the boundary of the pillar")
    _refuse(outer, alone, "facets of its joints have no coincident partner")
    _refuse(outer, (group > 0) & (partners > 1), "facets of its joints have more than one partner")
    loose = np.zeros(len(group), dtype=bool)
    loose[pair[of_pair == 0]] = True
    _refuse(outer, loose, "facets coincide with others and are in no group 'joint...'")
    return facets.joints(outer, pair, _law(outer.chosen(pair[:, 0]), of_pair, p))


def place(x: np.ndarray) -> str:
    """Return a place as text for an error message."""
    return "(" + ", ".join(f"{value:.6g}" for value in x) + ") m"


def _refuse(outer: Facets, wrong: np.ndarray, fault: str) -> None:
    if wrong.any():
        where = place(outer.middle[wrong.argmax()])
        raise MeshError(f"{wrong.sum()} {fault}, the first at {where}")


def _on_outside(outer: Facets, p: Properties) -> np.ndarray:
    """Return which facets lie on a face of the pillar, bool array [facets]."""
    length, dim = p.spacing * p.block_count, outer.corners.shape[2]
    middle, half = np.array([0, length / 2, 0])[:dim], np.full(3, p.side / 2)[:dim]
    half[1] = length / 2
    depth = np.abs(np.abs(outer.corners - middle) - half)
    return (depth <= ACROSS * length).all(axis=1).any(axis=1)


def _law(facet: Facets, group: np.ndarray, p: Properties) -> np.ndarray:
    """Return the pillar's joint nearest in y, int array [facets].

    Facets across the pillar use their own position, all others the mean of their group.
    """
    y = facet.y
    inclined = ~facets.lies_across(facet, ACROSS * p.spacing * p.block_count)
    for k in np.unique(group[inclined]):
        y[inclined & (group == k)] = y[inclined & (group == k)].mean()
    return np.clip(np.rint(y / p.spacing).astype(np.int64) - 1, 0, p.block_count - 2)
