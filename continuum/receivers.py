"""How motion and stress are read at any place along the bar."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial as poly
from scipy.sparse import csr_matrix, lil_matrix

from continuum.elasticity import Bar


class Sections(NamedTuple):
    """Section force = elastic (u + eta u') + inertia u'', for a bar of unit E, rho and A.

    elastic, inertia : [sections, nodes], 1/m and m; empty rows for sections on a cut.
    contact : [sections, cuts], one where a section is on a cut and reads its traction.
    """

    elastic: csr_matrix
    inertia: csr_matrix
    contact: csr_matrix


def points(bar: Bar, places: list[float]) -> csr_matrix:
    """Return the interpolation [places, nodes] by the elements' own polynomials.

    On a joint the receiver reads the mean of both sides.
    """
    matrix = lil_matrix((len(places), bar.y.size))
    for r, y in enumerate(places):
        around = _elements_at(bar, y)
        for e in around:
            for i, share in zip(bar.elements[e], poly.polyval(*_local(bar, e, y)), strict=True):
                matrix[r, i] += share / len(around)
    return matrix.tocsr()


def sections(bar: Bar, places: list[float]) -> Sections:
    """Return how section forces are read, by the momentum balance of part of an element.

    From the element's left end to y: force(y) = force(left) - integral of rho A u'', where
    force(left) balances stiffness and inertia of the left node within the element. This is as
    accurate as the displacements; their derivative would lose an order (Wheeler, SIAM J. Numer.
    Anal. 11, 1974, for the flux at a node). At either end of the pillar it is the force applied
    there; it tends to the joint's traction towards a cut, which is read where the section is on it.
    """
    cuts = np.flatnonzero(bar.grid.cut)
    elastic, inertia = (lil_matrix((len(places), bar.y.size)) for _ in range(2))
    contact = lil_matrix((len(places), cuts.size))
    for r, y in enumerate(places):
        e = _elements_at(bar, y)[0]
        on = np.flatnonzero(_is_near(bar, bar.grid.edges[cuts + 1], y))
        if on.size:
            contact[r, on[0]] = 1.0
            continue
        nodes = bar.elements[e]
        # Beside its first entry, the row of the left node holds this element alone.
        stiffness = bar.stiffness[nodes[0], nodes].toarray()[0]
        stiffness[0] = -stiffness[1:].sum()
        local, basis = _local(bar, e, y)
        running = poly.polyint(basis)
        mass = -poly.polyval(local, running)
        mass[0] += poly.polyval(1.0, running)[0]
        elastic[r, nodes] = stiffness
        inertia[r, nodes] = mass * (bar.grid.edges[e + 1] - bar.grid.edges[e])
    return Sections(elastic.tocsr(), inertia.tocsr(), contact.tocsr())


def _elements_at(bar: Bar, y: float) -> np.ndarray:
    near = _is_near(bar, bar.grid.edges, y)
    inside = (bar.grid.edges[:-1] <= y) & (y <= bar.grid.edges[1:])
    return np.flatnonzero(inside | near[:-1] | near[1:])


def _is_near(bar: Bar, edges: np.ndarray, y: float) -> np.ndarray:
    return np.abs(edges - y) <= 1e-9 * bar.grid.edges[-1]


def _local(bar: Bar, e: int, y: float) -> tuple[float, np.ndarray]:
    """Return y in the element's coordinate 0 .. 1, and the coefficients of its basis there."""
    nodes = bar.y[bar.elements[e]]
    start, size = nodes[0], nodes[-1] - nodes[0]
    local = (nodes - start) / size
    basis = poly.polyfit(local, np.eye(local.size), bar.order)
    return min(max((y - start) / size, 0.0), 1.0), basis
