"""A body from a conforming mesh of blocks: nodes of their own along joints, rock and joints."""

import logging
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import ufl
from scipy.sparse import csr_matrix

from jointwave.cases.geometry.relations import joined
from jointwave.continuum.mesh.conforming import Conforming, Places, cut_open, shared
from jointwave.continuum.mesh.domain import Marks
from jointwave.continuum.mesh.periodic import Facing
from jointwave.continuum.space.bubbles import bubble_element
from jointwave.continuum.space.compat import (
    cell_nodes,
    input_cells,
    lagrange,
    make_mesh,
    matrix,
    reference,
    vector_space,
)
from jointwave.continuum.space.jump_operator import jump_operator
from jointwave.continuum.space.model import Body, Facets, Forms, JumpOperator, in_motion
from jointwave.continuum.space.traces import Trace, reference_cell, trace

log = logging.getLogger("jointwave")
ROUND_OFF = 1e-14  # of entries, relative
SIMPLEX = ("triangle", "tetrahedron")
LEVEL = 1e-9  # of the pillar: nodes at one height


class Elements:
    """A dolfinx space on a mesh of blocks that is open along its joints.

    row : int array [cells], of the mesh of blocks, for each of dolfinx's. nodes : of the body, of
    the mesh's cells [cells, n]. x : [nodes of the space, d], m. tied : as `Body` has it.
    """

    tied: np.ndarray | None

    def __init__(
        self, mesh: Conforming, opened: tuple, order: int, components: int, consistent: bool
    ) -> None:
        (cells, origin), kind = opened, mesh.kind
        self.mesh, self.corners, self.tied = mesh, mesh.x[mesh.cells], None
        self.domain = make_mesh(kind, mesh.x[origin], cells)
        self.row = input_cells(self.domain)
        if kind in SIMPLEX and order == 2 and not consistent:
            element = bubble_element(kind)
            self.space = vector_space(self.domain, element, components)
        else:
            element = reference(kind, order)
            self.space = lagrange(self.domain, order, components)
        self.cell = reference_cell(kind, order, element)
        self.nodes = np.empty((len(self.row), len(self.cell.shares)), np.int64)
        self.nodes[self.row] = cell_nodes(self.space)
        self.x = np.empty((self.nodes.max() + 1, mesh.x.shape[1]))
        self.x[self.nodes] = self.cell.shares @ self.corners

    def trace(self, facets: Places, vertices: np.ndarray | None = None) -> Trace:
        """Return the nodes of facets; vertices : that decide their order, of the mesh."""
        own = self.mesh.cells if vertices is None else vertices[self.mesh.cells]
        return trace(self.cell, self.nodes, own, self.corners, facets)

    def both(self, pairs: Places, vertices: np.ndarray | None = None) -> tuple[Trace, Trace]:
        """Return the nodes of facets i and of those that they face, j."""
        return self.trace(pairs.side(0), vertices), self.trace(pairs.side(1), vertices)

    def tie(self, found: Sequence[Facing]) -> None:
        """Let the nodes of rock that is whole across periodic sides be one."""
        whole = [(one.pairs.of(~one.joint), one.vertices) for one in found if not one.joint.all()]
        if whole:
            sides = [np.stack([t.node.ravel() for t in self.both(*one)], axis=1) for one in whole]
            self.tied = joined(np.concatenate(sides), len(self.x))
            self.nodes = self.tied[self.nodes]

    def flatten(self) -> None:
        """Let all nodes at one y of each piece of rock be one."""
        cell = np.repeat(np.arange(len(self.nodes)), self.nodes.shape[1])
        piece = joined(np.stack([self.nodes[cell, 0], self.nodes.ravel()], axis=1), len(self.x))
        level = np.rint((self.x[:, 1] - self.x[:, 1].min()) / np.ptp(self.x[:, 1]) / LEVEL)
        places = np.column_stack([piece, level])
        self.tied = np.unique(places, axis=0, return_inverse=True)[1].reshape(-1)
        self.nodes = self.tied[self.nodes]


def build_body(
    mesh: Conforming,
    marks: Marks,
    order: int,
    rock: Callable[[Any, np.ndarray], Forms],
    components: int | None = None,
    consistent: bool = False,
    across: Sequence[Facing] = (),
    flat: bool = False,
) -> Body:
    """Return the body of a mesh.

    rock : function of the dolfinx space, and the block of each of its cells. components : of
    displacements; as many as dimensions where absent. consistent : whether the mass is the
    consistent one. across : what periodic sides face, with columns of their own. flat : whether
    sections across y of each piece of rock move as a whole.
    """
    pairs, size = shared(mesh), components or mesh.x.shape[1]
    column = _marked(marks.column, mesh.on[pairs.cell, pairs.facet]).max(axis=1)
    cut = column >= 0
    found = Elements(mesh, cut_open(mesh, pairs, cut), order, size, consistent)
    block = mesh.block[found.row]
    forms = assembled(rock(found.space, block), mesh.kind, order, consistent)
    found.tie(across)
    if flat:
        found.flatten()
    x = found.x
    if found.tied is not None:
        x = x[np.unique(found.tied, return_index=True)[1]]
        forms = [None if one is None else _tied(one, found.tied, size) for one in forms]
    mass, stiffness, damping = forms
    return Body(
        mesh=found.domain,
        space=found.space,
        cell=found.cell,
        tied=found.tied,
        x=x,
        block=block,
        mass=None if consistent else np.asarray(mass.sum(axis=1)).ravel(),
        consistent=mass if consistent else None,
        stiffness=stiffness,
        damping=damping,
        joints=_joints(found, pairs.of(cut), column[cut], across, size),
        sides=_sides(found, marks, size),
    )


def _joints(
    found: Elements, pairs: Places, column: np.ndarray, across: Sequence[Facing], size: int
) -> JumpOperator | None:
    """Return the jump operator of pairs of facets, and of joints across periodic sides."""
    first = np.argsort(found.mesh.block[pairs.cell], axis=1, kind="stable")
    pairs = Places(*(np.take_along_axis(part, first, 1) for part in pairs))
    traces, columns = [found.both(pairs)] if len(column) else [], [column]
    for one in across:
        if one.joint.any():
            traces.append(found.both(one.pairs.of(one.joint), one.vertices))
            columns.append(one.column[one.joint])
    if not traces:
        return None
    i, j = (
        Trace(*map(np.concatenate, zip(*side, strict=True))) for side in zip(*traces, strict=True)
    )
    if closed := int((i.node == j.node).all(axis=1).sum()):
        log.warning(
            "%d of %d facets of joints have all nodes at the ends of joints and cannot open: "
            "take smaller elements",
            closed,
            len(i.node),
        )
    shape = int(found.nodes.max()) + 1, size
    return jump_operator(i, j, np.concatenate(columns), shape, found.cell)


def _sides(found: Elements, marks: Marks, size: int) -> dict[str, Facets]:
    """Return the facets of each side that there is."""
    outer, sides = _marked(marks.side, found.mesh.on), {}
    for k, name in enumerate(marks.names):
        facets = Places(*np.nonzero(outer == k))
        if len(facets.cell):
            own = found.trace(facets)
            dim, block = own.place.shape[2], found.mesh.block[facets.cell]
            sides[name] = Facets(
                node=own.node.ravel(),
                weight=own.weight.ravel(),
                normal=in_motion(own.normal.reshape(-1, dim), size),
                place=own.place.reshape(-1, dim),
                block=np.repeat(block, own.node.shape[1]),
            )
    return sides


def _tied(matrix: csr_matrix, tied: np.ndarray, size: int) -> csr_matrix:
    """Return a matrix of the freedoms of the body; matrix : of those of the space."""
    own = (size * tied[:, None] + np.arange(size)).ravel()
    ones = np.ones(own.size), (np.arange(own.size), own)
    motion = csr_matrix(ones, (own.size, own.max() + 1))
    return csr_matrix(motion.T @ matrix @ motion)


def _marked(marks: np.ndarray, facet: np.ndarray) -> np.ndarray:
    """Return the marks of facets of the complex, -1 of none."""
    return np.append(marks, -1)[facet]


def assembled(forms: Forms, kind: str, order: int, consistent: bool) -> list[Any]:
    """Return the matrices of mass, stiffness and damping (None without), assembled by dolfinx."""
    at_nodes = {} if consistent else nodal_rule(kind, order)
    rules = at_nodes, rock_rule(kind, order), rock_rule(kind, order)
    return [
        None if form is None else without_round_off(matrix(by_rule(form, rule)))
        for form, rule in zip(forms, rules, strict=True)
    ]


def without_round_off(matrix: csr_matrix) -> csr_matrix:
    """Return a symmetric positive semidefinite matrix without entries that are only round-off.

    No entry exceeds the geometric mean of its two diagonal ones; against that they are measured.
    """
    scale, entries = np.sqrt(np.abs(matrix.diagonal())), matrix.tocoo()
    real = np.abs(entries.data) > ROUND_OFF * scale[entries.row] * scale[entries.col]
    places = entries.row[real], entries.col[real]
    return csr_matrix((entries.data[real], places), matrix.shape)


def rock_rule(kind: str, order: int) -> dict[str, Any]:
    """Return the metadata of UFL's measure for stiffness and damping."""
    exact = kind in SIMPLEX or (kind, order) == ("hexahedron", 1)
    return {} if exact else nodal_rule(kind, order)


def nodal_rule(kind: str, order: int) -> dict[str, Any]:
    """Return the metadata of UFL's measure by which the mass is diagonal; none where sums of rows
    make it so."""
    if kind not in SIMPLEX:
        return {"quadrature_rule": "GLL", "quadrature_degree": max(2 * order - 1, 1)}
    return {"quadrature_rule": "vertex", "quadrature_degree": 1} if order == 1 else {}


def by_rule(form: ufl.Form, rule: dict[str, Any]) -> ufl.Form:
    """Return a form with this metadata in its integrals that state no rule of quadrature."""
    return ufl.Form([
        one.reconstruct(metadata={**rule, **one.metadata()}) for one in form.integrals()
    ])  # fmt: skip
