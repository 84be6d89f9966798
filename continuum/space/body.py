"""A whole body of discretised rock: its pieces with all their copies, in one numbering.

Nodes are numbered copy by copy; freedoms as `continuum.space.operator.layout` puts them. Where
plane sections are asked for in two or three dimensions, all nodes of a piece at the same y share
their freedoms. So do nodes across periodic sides.
"""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, kron

from jointwave.continuum.mesh.description import Mesh, Part
from jointwave.continuum.parallel.serial import SERIAL, Serial
from jointwave.continuum.space.elasticity import Piece, Rock, Section, discretise
from jointwave.continuum.space.nodes import levels, node_numbers
from jointwave.continuum.space.operator import Layout, Operator, layout, operator, spread


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
    materials: Sequence[Rock],
    section: Section,
    plane_sections: bool = False,
    consistent: bool = False,
    paired: bool = False,
) -> Body:
    """Return the discretised rock of a mesh; `materials` are the rock and the meshed layers.

    plane_sections : whether all nodes of a piece at one height move alike. paired : whether a last
    part that stands once is kept as pairs of rows (`continuum.space.operator`).
    """
    pieces = [discretise(p, mesh.cell, order, materials, section, consistent) for p in mesh.parts]
    numbers = [
        _heights(piece) if plane_sections else _moving(part, piece, mesh.cell, order)
        for part, piece in zip(mesh.parts, pieces, strict=True)
    ]
    ties = [_tie(number, section.components) for number in numbers]
    places = layout([part.copies for part in mesh.parts], [tie.shape[1] for tie in ties])

    def tied(matrices: Iterable[Any]) -> list[csr_matrix]:
        pairs = zip(ties, matrices, strict=True)
        return [csr_matrix(tie.T @ m @ tie) for tie, m in pairs if m is not None]

    mass = spread(
        places,
        [t.T @ np.repeat(p.mass, section.components) for t, p in zip(ties, pieces, strict=True)],
    )
    # Padding moves under no force: any mass will do, but none.
    mass[mass == 0] = mass.max()
    blocks, dashpots = tied(p.stiffness for p in pieces), tied(p.viscosity for p in pieces)
    whole_mass = tied(p.consistent for p in pieces)
    x, first, stride, cells = _nodes(mesh, pieces, places, numbers, section.components)
    corners, material, piece = cell_geometry(mesh)
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
        stiffness=operator(places, blocks, paired),
        viscosity=operator(places, dashpots, paired) if dashpots else None,
        blocks=blocks,
        viscous_blocks=dashpots,
        mass=mass,
        consistent=whole(places, mesh, whole_mass) if whole_mass else None,
    )


def rock_matrices(body: Body) -> tuple[csr_matrix, csr_matrix | None]:
    """Return the stiffness (N/m) and viscosity (N s/m) of all copies; None without dashpots."""
    stiffness = whole(body.layout, body.mesh, body.blocks)
    if not body.viscous_blocks:
        return stiffness, None
    return stiffness, whole(body.layout, body.mesh, body.viscous_blocks)


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


def _heights(piece: Piece) -> np.ndarray:
    """Return for each node the number of its height within the piece."""
    y = piece.x[:, axis(piece.x.shape[1])]
    return levels(y, max(np.ptp(y), np.abs(piece.x).max()))


def _moving(part: Part, piece: Piece, cell: str, order: int) -> np.ndarray:
    """Return numbers of the nodes of a piece, equal where they move alike [nodes]."""
    if part.tied is None:
        return np.arange(len(piece.x))
    label = np.empty(len(piece.x), dtype=np.int64)
    label[piece.cells] = node_numbers(cell, order, part.cells, part.tied)
    _, first, number = np.unique(label, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[number.reshape(-1)]


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


def _nodes(
    mesh: Mesh, pieces: list[Piece], places: Layout, numbers: list[np.ndarray], components: int
) -> tuple[np.ndarray, ...]:
    """Return the nodes of all copies, one copy after the other, the first freedom of each and how
    far apart its components are, and the nodes of the cells."""
    found, nodes, copies = [], 0, 0
    for part, piece, number in zip(mesh.parts, pieces, numbers, strict=True):
        here = slice(copies, copies + part.copies)
        stride = places.stride[here, None] + 0 * number
        first = places.first[here, None] + stride * components * number
        x = piece.x + part.shifts[:, None]
        cells = nodes + len(piece.x) * np.arange(part.copies)[:, None, None] + piece.cells
        parts = x.reshape(-1, x.shape[2]), first.ravel(), stride.ravel()
        found.append((*parts, cells.reshape(-1, piece.cells.shape[1])))
        nodes, copies = nodes + first.size, copies + part.copies
    return tuple(np.concatenate(columns) for columns in zip(*found, strict=True))
