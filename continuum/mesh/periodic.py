"""Matching facets of a mesh at pairs of periodic sides."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from jointwave.cases.geometry.cell_complex import NO_SET, Complex, GeometryError
from jointwave.cases.geometry.measure import facet_moments
from jointwave.cases.geometry.periodic import Across
from jointwave.continuum.mesh.conforming import Conforming, Places, facets_of

SAME = 1e-7  # distance, over the size of the domain, below which shifted places coincide


class Facing(NamedTuple):
    """Pairs of facets of cells at two periodic sides, the far and the near one.

    pairs : far, near. column : of the law [n]. joint : whether a joint lies there, bool [n].
    vertices : of the mesh [v], those at the near side replaced by their partners at the far side.
    """

    pairs: Places
    column: np.ndarray
    joint: np.ndarray
    vertices: np.ndarray


def facing(mesh: Conforming, body: Complex, across: Across, first: int) -> Facing:
    """Return the pairs of mesh facets across periodic sides; first : column of their first contact.

    Raises GeometryError if the meshes of the two sides do not match.
    """
    cell, facet = np.nonzero(np.append(~body.inner, False)[mesh.on])
    corners = mesh.cells[cell[:, None], facets_of(mesh.kind)[facet]]
    middle = mesh.x[corners].mean(axis=1)
    far, near, partner = _matched(body, across, middle, np.ones(len(middle), bool))
    if len(far) != len(near) or (partner < 0).any():
        at = middle[far[np.argmin(partner)]]
        cause = "is periodic, but the faces of blocks there differ from those that they face"
        raise GeometryError(at, cause, "boundaries")
    near = near[partner]
    at_far, at_near = (np.unique(corners[one]) for one in (far, near))
    _, match = cKDTree(mesh.x[at_far]).query(mesh.x[at_near] + across.shift)
    vertices = np.arange(len(mesh.x))
    vertices[at_near] = at_far[match]
    pairs = Places(*(np.stack([one[far], one[near]], axis=1) for one in (cell, facet)))
    known = across.contacts  # of the contacts between the same blocks, the nearest
    apart = np.abs(mesh.block[pairs.cell][:, None] - known.blocks).sum(axis=2) > 0
    away = np.linalg.norm(middle[far][:, None] - known.centroid, axis=2)
    contact = np.where(apart, np.inf, away).argmin(axis=1)
    return Facing(pairs, first + contact, known.joint_set[contact] != NO_SET, vertices)


def matching_facets(body: Complex, across: Across) -> np.ndarray:
    """Return pairs of matching facets of a complex at the far and near side [n, 2], without facets
    that face parts of several others."""
    far, near, alike = _matched(body, across, facet_moments(body).centroid, ~body.inner)
    return np.stack([far[alike >= 0], near[alike[alike >= 0]]], axis=1)


def matching_vertices(body: Complex, across: Sequence[Across]) -> np.ndarray:
    """Return for each vertex [v] of near sides its partner at the far side, for others itself."""
    found = np.arange(len(body.vertices))
    for one in across:
        far, near, alike = _matched(body, one, body.vertices, np.ones(len(found), bool))
        found[near[alike[alike >= 0]]] = found[far[alike >= 0]]
    return found


def fitted(body: Complex, across: Sequence[Across]) -> Complex:
    """Return a complex in the plane with edges at periodic sides split where the opposite side has
    a vertex; in space the complex itself."""
    for one in across if body.dim == 2 else ():
        axis = int(np.flatnonzero(one.shift)[0])
        ends = body.vertices[:, axis].max(), body.vertices[:, axis].min()
        tolerance = SAME * float(np.ptp(body.vertices, axis=0).max())
        for k, shift in ((0, one.shift), (1, -one.shift)):
            x = body.vertices
            own, other = (np.abs(x[:, axis] - ends[end]) < tolerance for end in (k, 1 - k))
            body = _split(body, own, x[other] + shift, tolerance)
    return body


def _split(body: Complex, own: np.ndarray, places: np.ndarray, tolerance: float) -> Complex:
    """Return a complex in the plane with edges between vertices `own` (bool [v]) split at the
    places [n, 2], m, that lie within them."""
    ends = body.bounds[0][:, 1].reshape(-1, 2)
    pieces, of, x = [], [], [*body.vertices]
    for facet, (a, b) in enumerate(ends.tolist()):
        chain, along = [a, b], body.vertices[b] - body.vertices[a]
        if own[a] and own[b]:
            length = float(np.linalg.norm(along))
            s = np.sort((places - body.vertices[a]) @ along / length)
            inside = s[(s > tolerance) & (s < length - tolerance)]
            chain[1:1] = range(len(x), len(x) + len(inside))
            x += [body.vertices[a] + along * (one / length) for one in inside]
        pieces += list(pairwise(chain))
        of += [facet] * (len(chain) - 1)
    bounds = np.stack([np.repeat(np.arange(len(of)), 2), np.ravel(pieces)], axis=1)
    facets = {key: getattr(body, key)[of] for key in ("sides", "plane", "joint_set", "side")}
    return replace(body, vertices=np.array(x), bounds=(bounds,), **facets)


def _matched(
    body: Complex, across: Across, x: np.ndarray, chosen: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return which of the chosen places x [n, d] are at the far side, which at the near side, and
    for each far one the position of its partner among the near ones, or -1."""
    axis = int(np.flatnonzero(across.shift)[0])
    tolerance = SAME * float(np.ptp(body.vertices, axis=0).max())
    ends = body.vertices[:, axis].max(), body.vertices[:, axis].min()
    far, near = (np.flatnonzero(chosen & (np.abs(x[:, axis] - end) < tolerance)) for end in ends)
    distance, partner = cKDTree(x[near] + across.shift).query(x[far])
    return far, near, np.where(distance < tolerance, partner, -1)
