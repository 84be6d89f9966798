"""A body from a conforming mesh of blocks: doubled nodes along joints, rock and jump operator."""

import logging
from collections.abc import Sequence
from typing import Any

import numpy as np
import ufl
from scipy.sparse import csr_matrix
from ufl.algorithms.analysis import has_type

from jointwave.cases.geometry.relations import joined
from jointwave.continuum.mesh.conforming import SIMPLEX, Conforming, Marks, Places, cut_open, shared
from jointwave.continuum.mesh.periodic import Facing
from jointwave.continuum.space import compat
from jointwave.continuum.space.bubbles import bubble_element
from jointwave.continuum.space.model import (
    Body,
    Facets,
    Forms,
    JumpOperator,
    in_motion,
    jump_operator,
)
from jointwave.continuum.space.traces import Trace, reference_cell, trace

log = logging.getLogger("jointwave")
ROUND_OFF = 1e-14  # of matrix entries, relative
LEVEL = 1e-9  # difference, over the length of the pillar, of nodes at the same y


class Elements:
    """A dolfinx space on a mesh of blocks cut along its joints; `body` adds the rock.

    space : of displacements. block : of dolfinx's cells [cells]. nodes : of the body, in the order
    of `Conforming.cells` [cells, n]. x : nodes of the space [n, d], m. tied : as in `Body`.
    """

    def __init__(
        self,
        mesh: Conforming,
        marks: Marks,
        order: int,
        components: int | None = None,
        across: Sequence[Facing] = (),
        flat: bool = False,
    ) -> None:
        """components : of displacements; absent: the dimension. across : facets across periodic
        sides. flat : whether nodes of a piece of rock at the same y move together."""
        self.mesh, self.marks, self.across, kind = mesh, marks, across, mesh.kind
        self.size, self.corners = components or mesh.x.shape[1], mesh.x[mesh.cells]
        pairs = shared(mesh)
        column = _marked(marks.column, mesh.on[pairs.cell, pairs.facet]).max(axis=1)
        self.pairs, self.column = pairs.of(column >= 0), column[column >= 0]
        cells, origin = cut_open(mesh, pairs, column >= 0)
        self.domain = compat.make_mesh(kind, mesh.x[origin], cells)
        if kind in SIMPLEX and order == 2:
            element = bubble_element(kind)
            self.space = compat.vector_space(self.domain, element, self.size)
        else:
            element = compat.reference(kind, order)
            self.space = compat.lagrange(self.domain, order, self.size)
        self.cell, row = reference_cell(kind, order, element), compat.input_cells(self.domain)
        self.block, nodes = mesh.block[row], compat.cell_nodes(self.space)
        self.nodes = np.empty_like(nodes, np.int64)
        self.nodes[row] = nodes
        self.x = np.empty((nodes.max() + 1, mesh.x.shape[1]))
        self.x[self.nodes] = self.cell.shares @ self.corners
        self.tied = self._tied(flat)
        if self.tied is not None:
            self.nodes = self.tied[self.nodes]

    def _tied(self, flat: bool) -> np.ndarray | None:
        """Return the representative of each node [nodes] among tied nodes, those of intact rock
        across periodic sides or of flat sections; None without tied nodes."""
        count, x = len(self.x), self.x
        if flat:
            cell = np.repeat(self.nodes[:, :1], self.nodes.shape[1], axis=1)
            piece = joined(np.stack([cell.ravel(), self.nodes.ravel()], axis=1), count)
            level = np.rint((x[:, 1] - x[:, 1].min()) / np.ptp(x[:, 1]) / LEVEL)
            places = np.column_stack([piece, level])
            return np.unique(places, axis=0, return_inverse=True)[1].reshape(-1)
        whole = [(one.pairs.of(~one.joint), one.vertices) for one in self.across]
        sides = [
            np.stack([t.node.ravel() for t in self._pair_of_traces(*one)], axis=1)
            for one in whole
            if len(one[0].cell)
        ]
        return joined(np.concatenate(sides), count) if sides else None

    def _trace(self, facets: Places, vertices: np.ndarray | None = None) -> Trace:
        """Return the nodes of facets; vertices : numbers that define the order [v]."""
        own = self.mesh.cells if vertices is None else vertices[self.mesh.cells]
        return trace(self.cell, self.nodes, own, self.corners, facets)

    def _pair_of_traces(
        self, pairs: Places, vertices: np.ndarray | None = None
    ) -> tuple[Trace, Trace]:
        """Return the nodes of facets of blocks i and of their partners, of blocks j."""
        return self._trace(pairs.side(0), vertices), self._trace(pairs.side(1), vertices)

    def body(self, rock: Forms) -> Body:
        """Return the body with this rock."""
        x, forms = self.x, assembled(rock, self.cell.kind, self.cell.order)
        if self.tied is not None:
            own = (self.size * self.tied[:, None] + np.arange(self.size)).ravel()
            motion = csr_matrix((np.ones(own.size), (np.arange(own.size), own)))
            forms = [csr_matrix(motion.T @ one @ motion) for one in forms]
            x = x[np.unique(self.tied, return_index=True)[1]]
        mass, stiffness, damping = forms
        return Body(
            mesh=self.domain,
            space=self.space,
            cell=self.cell,
            tied=self.tied,
            x=x,
            block=self.block,
            mass=np.asarray(mass.sum(axis=1)).ravel(),
            stiffness=stiffness,
            damping=damping,
            joints=self._joints(),
            sides=self._sides(),
        )

    def _joints(self) -> JumpOperator:
        """Return the jump operator of joints, those across periodic sides last."""
        first = np.argsort(self.mesh.block[self.pairs.cell], axis=1, kind="stable")
        pairs = Places(*(np.take_along_axis(part, first, 1) for part in self.pairs))
        parts: list[tuple] = [(pairs, None, self.column)]
        for one in self.across:
            parts.append((one.pairs.of(one.joint), one.vertices, one.column[one.joint]))
        parts = [one for one in parts if len(one[2])]
        if not parts:
            none, frame = np.zeros((0, 2), np.int64), np.zeros((0, self.size, self.size))
            return JumpOperator(none, np.zeros(0), none[:, 0], frame, self.x[:0])
        i, j = (
            Trace(*map(np.concatenate, zip(*side, strict=True)))
            for side in zip(*(self._pair_of_traces(*one[:2]) for one in parts), strict=True)
        )
        if closed := int((i.node == j.node).all(axis=1).sum()):
            log.warning(
                "%d of %d facets of joints have all nodes at the ends of joints and cannot open: "
                "take smaller elements",
                closed,
                len(i.node),
            )
        return jump_operator(i, j, np.concatenate([one[2] for one in parts]), self.size)

    def _sides(self) -> dict[str, Facets]:
        """Return the facets of each existing side."""
        outer, sides = _marked(self.marks.side, self.mesh.on), {}
        for k, name in enumerate(self.marks.names):
            facets = Places(*np.nonzero(outer == k))
            if len(facets.cell):
                own = self._trace(facets)
                dim = own.place.shape[2]
                sides[name] = Facets(
                    node=own.node.ravel(),
                    weight=own.weight.ravel(),
                    normal=in_motion(own.normal.reshape(-1, dim), self.size),
                    place=own.place.reshape(-1, dim),
                )
        return sides


def _marked(marks: np.ndarray, facet: np.ndarray) -> np.ndarray:
    """Return the marks of facets of the complex, -1 for facet -1."""
    return np.append(marks, -1)[facet]


def assembled(forms: Forms, kind: str, order: int) -> list[Any]:
    """Assemble mass, stiffness and damping (without entries if absent) with dolfinx."""
    rules = nodal_rule(kind, order), rock_rule(kind, order), rock_rule(kind, order)
    both = [one for one in zip(forms, rules, strict=True) if one[0] is not None]
    found = [without_round_off(compat.matrix(by_rule(*one))) for one in both]
    return [*found, csr_matrix(found[0].shape)][: len(forms)]


def without_round_off(matrix: csr_matrix) -> csr_matrix:
    """Return a symmetric positive semidefinite matrix without entries of round-off, relative to the
    geometric mean of the two diagonal entries, which bounds every entry."""
    scale, entries = np.sqrt(np.abs(matrix.diagonal())), matrix.tocoo()
    real = np.abs(entries.data) > ROUND_OFF * scale[entries.row] * scale[entries.col]
    places = entries.row[real], entries.col[real]
    return csr_matrix((entries.data[real], places), matrix.shape)


def rock_rule(kind: str, order: int) -> dict[str, Any]:
    """Return the UFL metadata of integrals for stiffness and damping."""
    exact = kind in SIMPLEX or (kind, order) == ("hexahedron", 1)
    return {} if exact else nodal_rule(kind, order)


def nodal_rule(kind: str, order: int) -> dict[str, Any]:
    """Return the UFL metadata of integrals for a diagonal mass; none where row sums are used."""
    if kind not in SIMPLEX:
        return {"quadrature_rule": "GLL", "quadrature_degree": max(2 * order - 1, 1)}
    return {"quadrature_rule": "vertex", "quadrature_degree": 1} if order == 1 else {}


def by_rule(form: ufl.Form, rule: dict[str, Any]) -> ufl.Form:
    """Return a form with this metadata in integrals that state no quadrature rule.

    Integrals of functions of place keep UFL's default, with points inside cells: at nodes on faces,
    a modulus that jumps there would have the value of one side.
    """
    integrals = []
    for one in form.integrals():
        own = {} if has_type(one.integrand(), ufl.classes.SpatialCoordinate) else rule
        integrals.append(one.reconstruct(metadata={**own, **one.metadata()}))
    return ufl.Form(integrals)
