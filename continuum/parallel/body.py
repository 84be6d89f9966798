"""The share that one process has of discretised rock and its joints.

Cells keep the numbers that they have in the whole mesh, so that all that is decided by the places
of cells is decided alike everywhere. Cells of others have no nodes here.
"""

from typing import NamedTuple

import numpy as np

from continuum.body import Body, build_body, cell_geometry
from continuum.elasticity import Material, Section, discretise
from continuum.interface import Jumps, jumps
from continuum.meshing.description import Mesh, Part
from continuum.parallel.identity import Border, border
from continuum.parallel.partition import Share, ranks_of_cells, restrict
from continuum.parallel.team import Team, in_turn

NOTHING = Material(0.0, 0.0, 0.0)  # of which ghosts are made


def share_of(
    comm,
    mesh: Mesh,
    order: int,
    materials: list[Material],
    section: Section,
    plane_wave: bool = False,
    consistent: bool = False,
) -> tuple[Body, Jumps | None]:
    """Return this process's share of the rock, and of the jumps across joints; None without any.

    comm : mpi4py's communicator. The rest is as for `build_body`.
    """
    rank_of = ranks_of_cells(mesh, comm.size)
    share = restrict(mesh, rank_of, comm.rank)
    with in_turn(comm):
        _compile(mesh, order, materials, section, consistent)
    materials = [*materials, NOTHING]
    local = mesh._replace(parts=share.parts)
    held = build_body(local, order, materials, section, plane_wave, consistent)
    corners, material = cell_geometry(mesh)
    everything = held._replace(
        cells=_table(held, share, rank_of.size), corners=corners, material=material
    )
    across = None
    if share.joints.joint.size:
        across = jumps(everything._replace(mesh=local._replace(joints=share.joints)))
    own = np.where(rank_of[:, None] == comm.rank, everything.cells, -1)
    body = everything._replace(cells=own, mass=_own_mass(held, share))
    meeting = border(mesh, rank_of, order)
    tied = border(mesh, rank_of, order, plane_wave) if plane_wave else meeting
    names = _names(everything, own, across, tied)
    return body._replace(team=Team(comm, *names, held.mass.size, meeting)), across


def _compile(
    mesh: Mesh, order: int, materials: list[Material], section: Section, consistent: bool
) -> None:
    """Discretise a single cell, for which the form compiler does all that it does for many."""
    part = mesh.parts[0]
    corners = part.cells.shape[1]
    one = Part(part.x[part.cells[0]], np.arange(corners)[None], part.material[:1], part.shifts[:1])
    discretise(one, mesh.cell, order, materials, section, consistent)


def _table(held: Body, share: Share, count: int) -> np.ndarray:
    """Return the nodes of all `count` cells [count, nodes per cell], -1 of those not held."""
    found = np.full((count, held.cells.shape[1]), -1)
    found[share.cell] = held.cells
    return found


def _own_mass(held: Body, share: Share) -> np.ndarray:
    """Return the mass, of which mere ghosts have none."""
    mass = held.mass.copy()
    own = _freedoms(held, held.cells[~share.ghost])
    mass[np.setdiff1d(_freedoms(held, held.cells[share.ghost]), own)] = 0.0
    return mass


class Names(NamedTuple):
    """The freedoms that a process's cells or joints have; those of them on the border, and what
    each of these is called on every process, ascending; int arrays."""

    freedom: np.ndarray
    border: np.ndarray
    name: np.ndarray


def _names(held: Body, own: np.ndarray, across: Jumps | None, border: Border) -> Names:
    """Return the names of what is held by these cells (own) and joints."""
    reached = [_freedoms(held, own[own[:, 0] >= 0])]
    if across is not None:
        matrices = across.opening, across.slip_x, across.slip_z
        reached += [np.unique(m.indices) for m in matrices if m is not None]
    freedom = np.unique(np.concatenate(reached))
    node = held.cells[border.cell]
    components = np.arange(held.section.components)
    found = held.freedom(node[node >= 0][:, None], components)
    name = border.node[node >= 0][:, None] * components.size + components
    here = np.isin(found, freedom)
    name, first = np.unique(name[here], return_index=True)
    return Names(freedom, found[here][first], name)


def _freedoms(body: Body, cells: np.ndarray) -> np.ndarray:
    """Return all freedoms of cells, whose nodes are given."""
    return np.unique(body.freedom(np.unique(cells)[:, None], np.arange(body.section.components)))
