"""A whole pillar of discretised rock: its pieces with all their copies, in one numbering.

Nodes are numbered copy by copy; freedoms as `continuum.space.operator.layout` puts them. Where a
plane wave is asked for in two or three dimensions, all nodes of a piece at the same y share their
freedoms, and the rock moves as if it were of infinite extent.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, kron

from continuum.mesh.description import Mesh
from continuum.parallel.serial import SERIAL, Serial
from continuum.space.elasticity import Material, Piece, Section, discretise
from continuum.space.operator import Layout, Operator, layout, operator, spread

SAME = 1e-9  # of the pillar's size: nodes that are at one height


class Body(NamedTuple):
    """Discretised rock in one numbering.

    mesh, order, section : what it was made from. layout : where every freedom stands.
    x : float array [nodes, dim], m. first, stride : int arrays [nodes]; component c of a node is
        the freedom first + c stride. cells : int array [cells, nodes per cell], reference order.
    corners : float array [cells, corners, dim], m. material, piece : int arrays [cells], what each
        is made of, and which copy of which part it belongs to.
    stiffness, viscosity : of all copies, N/m and N s/m; viscosity None without dashpots in rock.
    blocks, viscous_blocks : the same of one copy of each part [n, n], for `whole`.
    mass : float array [layout.length], kg; consistent : as a matrix, kg, None where lumped.
    communicator : of the processes that share the body. Of several, `mesh.parts`, nodes, freedoms
        and operators are of one of them; cells are those of all, and -1 the nodes that it lacks.
    """

    mesh: Mesh
    order: int
    section: Section
    layout: Layout
    x: np.ndarray
    first: np.ndarray
    stride: np.ndarray
    cells: np.ndarray
    corners: np.ndarray
    material: np.ndarray
    piece: np.ndarray
    stiffness: Operator
    viscosity: Operator | None
    blocks: list[csr_matrix]
    viscous_blocks: list[csr_matrix]
    mass: np.ndarray
    consistent: csr_matrix | None
    communicator: Serial = SERIAL

    @property
    def dim(self) -> int:
        """Dimension of the mesh."""
        return self.x.shape[1]

    @property
    def degrees_of_freedom(self) -> int:
        """Values that move, padding left out."""
        sizes = (block.shape[0] for block in self.blocks)
        return self.communicator.count(
            sum(p.copies * n for p, n in zip(self.mesh.parts, sizes, strict=True))
        )

    @property
    def length(self) -> float:
        """Of the pillar, m."""
        return float(np.ptp(self.corners[:, :, axis(self.dim)]))

    @property
    def y(self) -> np.ndarray:
        """Heights of the nodes [nodes], m."""
        return self.x[:, axis(self.dim)]

    def freedom(self, node: np.ndarray, component: int | np.ndarray) -> np.ndarray:
        """Return the freedoms of one component at nodes."""
        return self.first[node] + component * self.stride[node]


def axis(dim: int) -> int:
    """Return which coordinate of a mesh of this dimension runs along the pillar."""
    return 0 if dim == 1 else 1


def along(section: Section) -> int:
    """Return which component of the motion is along the pillar."""
    return 0 if section.components == 1 else 1


def build_body(
    mesh: Mesh,
    order: int,
    materials: list[Material],
    section: Section,
    plane_wave: bool = False,
    consistent: bool = False,
) -> Body:
    """Return the discretised rock of a mesh; `materials` are the rock and the meshed layers.

    plane_wave : whether all nodes of a piece at one height move alike.
    """
    pieces = [discretise(p, mesh.cell, order, materials, section, consistent) for p in mesh.parts]
    numbers = [_levels(p) if plane_wave else np.arange(len(p.x)) for p in pieces]
    ties = [_tie(number, section.components) for number in numbers]
    counts = [part.copies for part in mesh.parts]
    places = layout(counts, [tie.shape[1] for tie in ties])
    viscous = any(piece.viscosity is not None for piece in pieces)
    masses = [
        tie.T @ np.repeat(piece.mass, section.components)
        for tie, piece in zip(ties, pieces, strict=True)
    ]
    x, cells = _copies(mesh, pieces)
    corners, material, piece = cell_geometry(mesh)
    first, stride = _numbering(places, counts, numbers, section.components)
    blocks = [tie.T @ piece.stiffness @ tie for tie, piece in zip(ties, pieces, strict=True)]
    dashpots = _viscosities(pieces, ties) if viscous else []
    mass = spread(places, masses)
    # Padding moves under no force: any mass will do, but none.
    mass[mass == 0] = mass.max()
    return Body(
        mesh=mesh,
        order=order,
        section=section,
        layout=places,
        x=x,
        first=first,
        stride=stride,
        cells=cells,
        corners=corners,
        material=material,
        piece=piece,
        stiffness=operator(places, blocks),
        viscosity=operator(places, dashpots) if viscous else None,
        blocks=blocks,
        viscous_blocks=dashpots,
        mass=mass,
        consistent=_consistent(places, mesh, pieces, ties) if consistent else None,
    )


def whole(places: Layout, mesh: Mesh, blocks: list[csr_matrix]) -> csr_matrix:
    """Return the matrix of all copies in the numbering of the freedoms; empty rows for padding.

    blocks : [n, n] of one copy of each part.
    """
    rows, columns, values, base = [], [], [], 0
    for count, block in zip([part.copies for part in mesh.parts], blocks, strict=True):
        coo = block.tocoo()
        first, stride = (a[base : base + count, None] for a in (places.first, places.stride))
        rows.append((first + stride * coo.row).ravel())
        columns.append((first + stride * coo.col).ravel())
        values.append(np.tile(coo.data, count))
        base += count
    size = places.length
    ij = np.concatenate(rows), np.concatenate(columns)
    return csr_matrix((np.concatenate(values), ij), (size, size))


def _viscosities(pieces: list[Piece], ties: list[csr_matrix]) -> list[csr_matrix]:
    """Return the viscosity of one copy of each part, empty where the rock has no dashpots."""
    return [
        tie.T @ (csr_matrix(p.stiffness.shape) if p.viscosity is None else p.viscosity) @ tie
        for p, tie in zip(pieces, ties, strict=True)
    ]


def _levels(piece: Piece) -> np.ndarray:
    """Return for each node the number of its height within the piece."""
    y = piece.x[:, axis(piece.x.shape[1])]
    step = SAME * max(np.ptp(y), np.abs(piece.x).max())
    order = np.argsort(y)
    level = np.concatenate([[0], np.cumsum(np.diff(y[order]) > step)])
    found = np.empty(len(y), dtype=np.int64)
    found[order] = level
    return found


def _tie(number: np.ndarray, components: int) -> csr_matrix:
    """Return T [nodes * components, freedoms]: the motion of nodes is T times that of freedoms."""
    count = number.size
    nodes = csr_matrix((np.ones(count), (np.arange(count), number)), (count, number.max() + 1))
    return csr_matrix(kron(nodes, np.eye(components)))


def cell_geometry(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return corners, materials and pieces of the cells of all copies, one copy after the other."""
    corners, material, cells = [], [], []
    for part in mesh.parts:
        places = part.x[part.cells] + part.shifts[:, None, None, :]
        corners.append(places.reshape(-1, *places.shape[2:]))
        material.append(np.tile(part.material, part.copies))
        cells += [len(part.cells)] * part.copies
    piece = np.repeat(np.arange(len(cells)), cells)
    return np.concatenate(corners), np.concatenate(material), piece


def _copies(mesh: Mesh, pieces: list[Piece]) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and cells of all copies, one copy after the other."""
    x, cells, base = [], [], 0
    for part, piece in zip(mesh.parts, pieces, strict=True):
        nodes, copies = len(piece.x), part.copies
        x.append((piece.x + part.shifts[:, None]).reshape(-1, piece.x.shape[1]))
        numbers = base + nodes * np.arange(copies)[:, None, None] + piece.cells
        cells.append(numbers.reshape(-1, piece.cells.shape[1]))
        base += nodes * copies
    return np.concatenate(x), np.concatenate(cells)


def _numbering(
    places: Layout, counts: list[int], numbers: list[np.ndarray], components: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the first freedom of every node and how far apart its components are."""
    first, stride, base = [], [], 0
    for count, number in zip(counts, numbers, strict=True):
        of_block = slice(base, base + count)
        step = places.stride[of_block, None]
        first.append((places.first[of_block, None] + step * components * number).ravel())
        stride.append(np.repeat(step, number.size))
        base += count
    return np.concatenate(first), np.concatenate(stride)


def _consistent(
    places: Layout, mesh: Mesh, pieces: list[Piece], ties: list[csr_matrix]
) -> csr_matrix:
    """Return the consistent mass of all copies."""
    masses = []
    for piece, tie in zip(pieces, ties, strict=True):
        assert piece.consistent is not None
        masses.append(tie.T @ piece.consistent @ tie)
    return whole(places, mesh, masses)
