"""The sides of a body: where rock is held, absorbs waves, or bears its weight.

Quiet sides carry dashpots of rho a along their normal and rho b along themselves (Lysmer &
Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969) at the nodes, of the effective medium of the joint
sets that have a spacing.
"""

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.loads import base_steps
from jointwave.cases.material.quiet_sides import borne, medium_impedances
from jointwave.cases.partition.regions import region_at
from jointwave.cases.sampling import Clock
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import Load
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import PlaneLoad
from jointwave.continuum.space import compat
from jointwave.continuum.space.evaluation import nodes_of_cells
from jointwave.continuum.space.model import Body, Facets, directions
from jointwave.continuum.stepping.problem import Dashpots, Held

INSIDE = 1e-7  # of a cell: how far inside it a field is asked for, lest it is beyond a joint
ENDS = ("start", "end")  #: sides of a pillar that hold it or absorb waves
#: Sides by the axis of their normal.
AXIS = {
    2: {"left": 0, "right": 0, "bottom": 1, "top": 1},
    3: {"left": 0, "right": 0, "front": 1, "back": 1, "bottom": 2, "top": 2},
}


def facets_on(body: Body, names: list[str]) -> Facets:
    """Return the facets of sides, one after the other, at their nodes; each node once for each
    direction that its side has there."""
    own = [body.sides[name] for name in names if name in body.sides]
    dim = body.components
    if not own:
        none = np.zeros((0, dim))
        index = np.zeros(0, np.int64)
        return Facets(index, np.zeros(0), none, none, index)
    every = Facets(*(np.concatenate(parts) for parts in zip(*own, strict=True)))
    key = np.column_stack([every.node, np.rint(1e9 * every.normal)])
    _, first, group = np.unique(key, axis=0, return_index=True, return_inverse=True)
    weight = np.bincount(group.ravel(), every.weight)
    return Facets(
        every.node[first], weight, every.normal[first], every.place[first], every.block[first]
    )


def cells_behind(body: Body, facets: Facets) -> np.ndarray:
    """Return a cell at each node of facets, int array [n]."""
    nodes = nodes_of_cells(body)
    of_node = np.empty(len(body.x), np.int64)
    of_node[nodes] = np.arange(len(nodes))[:, None]
    return of_node[facets.node]


def inside(body: Body, facets: Facets) -> np.ndarray:
    """Return places just inside the rock of the nodes of facets [n, d], m."""
    centre = compat.cell_corners(body.mesh).mean(axis=1)
    return facets.place + INSIDE * (centre[cells_behind(body, facets)] - facets.place)


def impedances_of(scene: RockMass, body: Body, facets: Facets) -> np.ndarray:
    """Return rho a and rho b of the rock behind facets [n, 2], Pa s/m."""
    region = region_at(scene.regions, inside(body, facets))
    return medium_impedances(scene, facets.normal, region)


def along_and_across(normal: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return tensors [n, d, d] of a value along the normal and another across it, [n, 2]."""
    along = np.einsum("qi,qj->qij", normal, normal)
    across = np.eye(normal.shape[1]) - along
    return values[:, 0, None, None] * along + values[:, 1, None, None] * across


def quiet_sides(
    scene: RockMass, body: Body, impedances: Callable[[Facets], np.ndarray] | None = None
) -> Dashpots | None:
    """Return the dashpots of the quiet sides, None without any; impedances : of rock that is not
    the scene's, tensors [n, d, d], Pa s/m."""
    facets = facets_on(body, scene.boundaries.sides("quiet"))
    if not len(facets.node):
        return None
    if impedances is None:
        tensors = along_and_across(facets.normal, impedances_of(scene, body, facets))
    else:
        tensors = impedances(facets)
    node, group = np.unique(facets.node, return_inverse=True)
    viscosity = np.zeros((len(node), body.components, body.components))
    np.add.at(viscosity, group, facets.weight[:, None, None] * tensors)
    return Dashpots(node, viscosity)


def bearing_sides(scene: AnyScene, body: Body) -> csr_matrix | None:
    """Return the areas [freedoms, freedoms] of quiet sides that bear the weight beside their
    dashpots, m2; None without."""
    if scene.is_column:
        names = [name for name, bears in zip(ENDS, scene.bears, strict=True) if bears]
        facets = facets_on(body, names)
        tensors = facets.weight[:, None, None] * np.eye(body.components)
    else:
        facets = facets_on(body, scene.boundaries.sides("quiet"))
        bears = facets.weight[:, None] * borne(scene, facets.normal)
        tensors = along_and_across(facets.normal, bears)
    if not tensors.any():
        return None
    dim = body.components
    own = dim * facets.node[:, None] + np.arange(dim)
    row, column = np.repeat(own, dim, axis=1), np.tile(own, dim)
    return csr_matrix((tensors.ravel(), (row.ravel(), column.ravel())), body.stiffness.shape)


def held_sides(scene: AnyScene, body: Body, time: Clock | None = None) -> Held | None:
    """Return the freedoms of fixed sides, with the motion of one that is shaken, and those normal
    to roller sides; None without any."""
    dim, base, shaken = body.components, *_base(scene)
    direction = np.full(body.stiffness.shape[0], np.nan)
    for name, axes in _held(scene, dim):
        node, given = np.unique(facets_on(body, [name]).node), np.zeros(dim)
        if base is not None and name == shaken:
            given = np.array(base.direction, dtype=float)[directions(body)]
        for c in axes:
            of = dim * node + c
            kept = ~np.isnan(direction[of]) & (name != shaken)
            direction[of] = np.where(kept, direction[of], given[c])
    freedom = np.flatnonzero(~np.isnan(direction))
    if not freedom.size:
        return None
    steps = None
    if base is not None and time is not None:
        steps = base_steps(base, time.dt, time.steps + time.stride + 1).__getitem__
    return Held(freedom, direction[freedom], steps)


def _held(scene: AnyScene, dim: int) -> list[tuple[str, list[int]]]:
    """Return the sides that are held, and the components of their motion that are."""
    every = list(range(dim))
    if scene.is_column:
        return [(name, every) for name in ENDS if getattr(scene.ends, name) == "fixed"]
    fixed, rollers = (scene.boundaries.sides(kind) for kind in ("fixed", "roller"))
    return [*((name, every) for name in fixed), *((name, [AXIS[dim][name]]) for name in rollers)]


def _base(scene: AnyScene) -> tuple[Load | PlaneLoad | None, str | None]:
    """Return the motion of a base, and its side; None without."""
    if scene.is_column:
        return (scene.load, ENDS[0]) if scene.shakes_base else (None, None)
    base = next(iter(scene.bases), None)
    return base, None if base is None else base.side
