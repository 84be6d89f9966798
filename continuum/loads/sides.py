"""The sides of a body: fixed and roller sides, dashpots, and sides that bear the weight.

Quiet sides have dashpots at the nodes (Lysmer & Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969), with
the impedance of the effective medium of joint sets with a spacing, or of the bar at the ends of a
pillar. In jointed rock a matched end has half a joint in front of its dashpots (`joints.ends`).
"""

from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.loads import base_steps
from jointwave.cases.material.quiet_sides import Rocks, borne, half_joints, impedances
from jointwave.cases.partition.joints import region_at
from jointwave.cases.sampling import Clock
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.space import compat
from jointwave.continuum.space.evaluation import nodes_of_cells
from jointwave.continuum.space.model import Body, Facets, at_nodes, directions
from jointwave.continuum.stepping.problem import NO_DASHPOTS, Dashpots, Held
from jointwave.joints.ends import HalfSpring, half_spring

INSIDE = 1e-7  # depth in a cell, over its size, at which fields are evaluated: not beyond a joint
#: Sides by the axis of their normal.
AXIS = {
    2: {"left": 0, "right": 0, "bottom": 1, "top": 1},
    3: {"left": 0, "right": 0, "front": 1, "back": 1, "bottom": 2, "top": 2},
}


def facets_on(body: Body, names: list[str]) -> Facets:
    """Return the facets of sides at their nodes; each node appears once per normal direction."""
    own, none = [body.sides[name] for name in names if name in body.sides], np.zeros(0, np.int64)
    if not own:
        empty = np.zeros((0, body.components))
        return Facets(none, np.zeros(0), empty, empty)
    every = Facets(*(np.concatenate(parts) for parts in zip(*own, strict=True)))
    key = np.column_stack([every.node, np.rint(1e9 * every.normal)])
    _, first, group = np.unique(key, axis=0, return_index=True, return_inverse=True)
    found = Facets(*(part[first] for part in every))
    return found._replace(weight=np.bincount(group.ravel(), every.weight))


def absorbing(scene: AnyScene, body: Body) -> Facets:
    """Return the facets of sides that absorb waves."""
    return facets_on(body, scene.boundaries.sides("quiet", "matched"))


def cells_behind(body: Body, facets: Facets) -> np.ndarray:
    """Return a cell at each node of facets [n]."""
    nodes = nodes_of_cells(body)
    of_node = np.empty(len(body.x), np.int64)
    of_node[nodes] = np.arange(len(nodes))[:, None]
    return of_node[facets.node]


def inside(body: Body, facets: Facets) -> np.ndarray:
    """Return places just inside the rock at the nodes of facets [n, d], m."""
    centre = compat.cell_corners(body.mesh).mean(axis=1)
    return facets.place + INSIDE * (centre[cells_behind(body, facets)] - facets.place)


def impedances_of(
    scene: AnyScene, body: Body, facets: Facets, other: Rocks | None = None
) -> np.ndarray:
    """Return the impedance tensors of the rock behind facets [n, d, d], Pa s/m; other : rocks that
    replace the scene's, and the index of each cell's rock."""
    if other is not None:
        other = other[0], other[1][cells_behind(body, facets)]
    region = region_at(scene.regions, inside(body, facets))
    return impedances(scene, facets.normal, facets.place, region, other)


def quiet_sides(
    scene: AnyScene, body: Body, model: str = "jointed", other: Rocks | None = None
) -> Dashpots:
    """Return the dashpots of sides that absorb waves; other : as in `impedances_of`."""
    facets = absorbing(scene, body)
    if not len(facets.node):
        return NO_DASHPOTS
    tensors = impedances_of(scene, body, facets, other)
    if model == "jointed" and scene.boundaries.sides("matched"):
        return _matched(scene, facets, np.einsum("nii->ni", tensors))
    node, group = np.unique(facets.node, return_inverse=True)
    viscosity = np.zeros((len(node), body.components, body.components))
    np.add.at(viscosity, group, facets.weight[:, None, None] * tensors)
    return Dashpots(node, viscosity)


def _matched(scene: AnyScene, facets: Facets, z: np.ndarray) -> Dashpots:
    """Return the dashpots of ends, behind half a joint if matched; z : impedance [n, d], Pa s/m."""
    given, eta = half_joints(scene, facets.normal)
    weight, along = facets.weight[:, None], np.abs(facets.normal) > 0.5
    k = np.where(along, given[:, :1], given[:, 1:])

    def springs(dt: float) -> HalfSpring:
        own = half_spring(k, eta[:, None], z, dt)
        whole = weight * own.stiffness, weight * own.critical_stiffness
        return own._replace(stiffness=whole[0], critical_stiffness=whole[1])

    c = weight * np.where(k > 0, half_spring(k, eta[:, None], z).viscosity, z)
    return Dashpots(facets.node, c[:, :, None] * np.eye(z.shape[1]), springs if k.any() else None)


def bearing_sides(scene: AnyScene, body: Body) -> csr_matrix | None:
    """Return the areas [freedoms, freedoms], m2, of absorbing sides in the directions in which they
    bear the weight; None without."""
    facets = absorbing(scene, body)
    tensors = facets.weight[:, None, None] * borne(scene, facets.normal)
    return at_nodes(facets.node, tensors, body.mass.size) if tensors.any() else None


def held_sides(scene: AnyScene, body: Body, time: Clock | None = None) -> Held:
    """Return the freedoms of fixed sides, normal ones of rollers, and the motion of bases."""
    bases: list[Any] = scene.bases
    dim, n, moved = body.components, body.stiffness.shape[0], None
    held, direction = np.zeros(n, bool), np.zeros((n, len(bases)))
    ways = np.array([np.array(one.direction)[directions(body)] for one in bases]).reshape(-1, dim)
    for name in scene.boundaries.sides("fixed", "roller"):
        node, own = np.unique(facets_on(body, [name]).node), [one.side == name for one in bases]
        rolls = name in scene.boundaries.sides("roller")
        for c in [AXIS[dim][name]] if rolls else range(dim):
            held[dim * node + c] = True
            if any(own):
                direction[dim * node + c] = ways[:, c] * own
    if bases and time is not None:
        count = time.steps + time.stride + 1
        moved = np.column_stack([base_steps(one, time.dt, count) for one in bases]).__getitem__
    freedom = np.flatnonzero(held)
    return Held(freedom, direction[freedom], moved)
