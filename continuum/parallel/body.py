"""One process's share of the discretised rock and its joints.

Cells keep their numbers in the whole mesh, so that all decisions by the positions of cells are the
same on every process. Cells of other processes have no nodes here.
"""

from collections.abc import Sequence

import numpy as np

from jointwave.continuum.mesh.description import Mesh
from jointwave.continuum.parallel.communicator import Communicator
from jointwave.continuum.parallel.graph import ranks_by_graph
from jointwave.continuum.parallel.identity import Border, border
from jointwave.continuum.parallel.partition import (
    Share,
    cells_enough,
    copies_of,
    ranks_of_cells,
    restrict,
)
from jointwave.continuum.space.body import Body, build_body, cell_geometry
from jointwave.continuum.space.elasticity import Material, Rock, Section
from jointwave.continuum.space.interface import Jumps, jumps
from jointwave.numerics.mpi_barrier import arrive

NOTHING = Material(0.0, 0.0, 0.0)  # material of ghost cells


def share_of(
    comm,
    mesh: Mesh,
    order: int,
    materials: Sequence[Rock],
    section: Section,
    plane_sections: bool = False,
    consistent: bool = False,
    paired: bool = False,
) -> tuple[Body, Jumps | None]:
    """Return this process's share of the rock, and of the jumps across joints; None without any.

    comm : mpi4py's communicator. The rest is as for `build_body`; rock stored as pairs of rows is
    partitioned by its graph, a pillar in contiguous lengths.
    """
    # By one process, so that all use the same partition.
    ranks = ranks_by_graph if paired else ranks_of_cells
    cells_enough(copies_of(mesh), comm.size)
    found = ranks(mesh, comm.size) if comm.rank == 0 else None
    arrive(comm)
    rank_of = comm.bcast(found)
    share = restrict(mesh, rank_of, comm.rank, together=paired)
    asked = order, materials, section, plane_sections, consistent, paired
    held, across = held_share(mesh, share, *asked)
    own = np.where(rank_of[:, None] == comm.rank, held.cells, -1)
    meeting = border(mesh, rank_of, order)
    alike = plane_sections or any(part.tied is not None for part in mesh.parts)
    tied = border(mesh, rank_of, order, plane_sections, tied=True) if alike else meeting
    names = _names(held, own, across, tied)
    communicator = Communicator(comm, *names, held.mass.size, meeting)
    return held._replace(cells=own, communicator=communicator), across


def held_share(
    mesh: Mesh, share: Share, order: int, materials: Sequence[Rock], *asked
) -> tuple[Body, Jumps | None]:
    """Return the rock of a process, including ghosts, and the jumps across its own joints.

    Ghosts have neither stiffness nor mass.
    """
    local = mesh._replace(parts=share.parts)
    built = build_body(local, order, [*materials, NOTHING], *asked)
    corners, material, piece = cell_geometry(mesh)
    cells = np.full((len(corners), built.cells.shape[1]), -1)
    cells[share.cell] = built.cells
    own, ghosts = (_freedoms(built, built.cells[g]) for g in (~share.ghost, share.ghost))
    mass = built.mass.copy()
    mass[np.setdiff1d(ghosts, own)] = 0.0
    held = built._replace(cells=cells, corners=corners, material=material, piece=piece, mass=mass)
    if not share.joints.joint.size:
        return held, None
    return held, jumps(held._replace(mesh=local._replace(joints=share.joints)))


def _names(
    held: Body, own: np.ndarray, across: Jumps | None, border: Border
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the degrees of freedom of own cells and joints; those on the border, and their global
    names, ascending; int arrays."""
    reached = [_freedoms(held, own[own[:, 0] >= 0])]
    if across is not None:
        reached += [np.unique(matrix.indices) for matrix in across.matrices]
    freedom = np.unique(np.concatenate(reached))
    node = held.cells[border.cell]
    components = np.arange(held.section.components)
    found = held.freedom(node[node >= 0][:, None], components)
    name = border.node[node >= 0][:, None] * components.size + components
    here = np.isin(found, freedom)
    name, first = np.unique(name[here], return_index=True)
    return freedom, found[here][first], name


def _freedoms(body: Body, cells: np.ndarray) -> np.ndarray:
    """Return all degrees of freedom of cells, given by their nodes."""
    return np.unique(body.freedom(np.unique(cells)[:, None], np.arange(body.section.components)))
