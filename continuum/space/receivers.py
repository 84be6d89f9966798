"""Receivers: motion and stress at any place along the pillar."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial as poly
from scipy.sparse import csr_matrix, vstack

from jointwave.continuum.space import basix_versions
from jointwave.continuum.space.body import Body, axis
from jointwave.continuum.space.elasticity import (
    TENSOR,
    Material,
    elastic_moduli,
    mass_rule,
    stiffness_rule,
)
from jointwave.continuum.space.evaluation import (
    Places,
    cells_at,
    matrix_of,
    places_in,
    quadrature_in,
)
from jointwave.continuum.space.interface import Jumps

NEAR = 1e-9  # of the pillar: when a section is on a joint
PER_SIDE = 8  # Gauss points across a section that the mesh does not follow
CURL = np.array([[[0, 0, 0], [0, 0, 1], [0, -1, 0]], [[0, 0, -1], [0, 0, 0], [1, 0, 0]],
                 [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]])  # fmt: skip


class Points(NamedTuple):
    """Motion on the axis: u [components * places, freedoms], all of one component together, and
    rotation [3 * places, freedoms] about x, y, z; None where nothing turns."""

    motion: csr_matrix
    turn: csr_matrix | None


class Sections(NamedTuple):
    """Force over a section, along y, then x, then z: elastic u + viscous u' + inertia u'', N.

    elastic, viscous, inertia : [directions * sections, freedoms]; empty rows for sections on a
    joint. contact : [sections, q], the area (m2) of the points of the joint that a section is on.
    """

    elastic: csr_matrix
    viscous: csr_matrix
    inertia: csr_matrix
    contact: csr_matrix


def points(body: Body, places: list[float]) -> Points:
    """Return how motion is read on the axis; on a joint it is the mean of both sides."""
    x = np.zeros((len(places), body.dim))
    x[:, axis(body.dim)] = places
    which, cell = cells_at(body, x)
    share = shares_of_pieces(which, body.piece[cell])[:, None]
    at = places_in(body, cell, x[which])
    components, turn = np.arange(body.section.components), None
    motion = matrix_of(body, which, cell, per_component(share * at.basis, components), len(places))
    if body.dim > 1:
        # Half the curl; in dim 2 only that about z is there.
        curl = 0.5 * CURL[:, : body.dim, : body.dim]
        weights = np.einsum("aic,nki->ankc", curl, share[..., None] * at.gradient)
        turn = matrix_of(body, which, cell, weights, len(places))
    return Points(motion, turn)


def per_component(weights: np.ndarray, components: np.ndarray) -> np.ndarray:
    """Return weights [n, nodes] of every component by itself [components, n, nodes, components]."""
    return np.einsum("nk,dc->dnkc", weights, np.eye(len(components))[components])


def shares_of_pieces(which: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """Return the share of each cell [n] in the mean at the point that it is at: pieces that meet
    there count alike, however many of their cells do."""
    pieces = 1 + piece.max(initial=0)
    key = which * pieces + piece
    side, of_cell, cells = np.unique(key, return_inverse=True, return_counts=True)
    sides = np.bincount(side // pieces)
    return 1 / (sides[which] * cells[of_cell])


def sections(
    body: Body, jumps: Jumps | None, materials: list[Material], places: list[float]
) -> Sections:
    """Return the receivers of forces over sections."""
    directions, size, count = body.section.components, body.mass.size, len(places)
    nothing = 3 * (csr_matrix((directions, size)),)
    rows = [nothing if is_on_joint(body, y) else _section(body, materials, y) for y in places]
    # One direction of all sections after the other; nothing, so that there is some to stack, first.
    order = np.arange(count * directions).reshape(count, directions).T.ravel()
    elastic, viscous, inertia = (
        vstack(part).tocsr()[order + directions] for part in zip(nothing, *rows, strict=True)
    )
    contact = [_contact(body, jumps, place) for place in places]
    joined = vstack(contact).tocsr() if contact else csr_matrix((0, 0))
    return Sections(elastic, viscous, inertia, joined)


def _contact(body: Body, jumps: Jumps | None, place: float) -> csr_matrix:
    """Return the areas [1, q] of the joint's points, zero where the section is on none."""
    if jumps is None or not is_on_joint(body, place):
        return csr_matrix((1, 0 if jumps is None else jumps.weight.size))
    near = np.abs(jumps.x[:, axis(body.dim)] - place) <= NEAR * body.length
    return csr_matrix(np.where(near & jumps.flat, jumps.weight, 0.0))


def is_on_joint(body: Body, place: float) -> bool:
    """Return whether a section is on a joint, and reads its traction."""
    y = body.mesh.joints.corners[:, :, axis(body.dim)]
    return bool((np.abs(y - place) <= NEAR * body.length).all(axis=1).any())


def _section(body: Body, materials: list[Material], place: float) -> tuple[csr_matrix, ...]:
    """Return the elastic, viscous and inertia rows [directions, freedoms] of one section."""
    y = body.corners[:, :, axis(body.dim)]
    low, high, slack = y.min(axis=1), y.max(axis=1), NEAR * body.length
    here = np.flatnonzero((low <= place + slack) & (place <= high + slack))
    # At the border of two layers of cells, the first.
    layer = here[np.abs(low[here] - low[here].min()) <= slack]
    follows = (
        (np.abs(low[layer] - low[layer[0]]) <= slack)
        & (np.abs(high[layer] - high[layer[0]]) <= slack)
        & (np.minimum(y[layer] - low[layer, None], high[layer, None] - y[layer]) <= slack).all(1)
    ).all() and place <= high[layer[0]] + slack
    if follows and body.mesh.cell in TENSOR:
        return _by_momentum(body, materials, layer, place)
    return _by_stress(body, materials, place)


def _by_momentum(
    body: Body, materials: list[Material], layer: np.ndarray, place: float
) -> tuple[csr_matrix, ...]:
    """Return a section's force by the momentum balance of part of a layer of cells.

    From the near face of the layer to y: force(y) = force(near) - integral of rho u'', where
    force(near) balances stiffness and inertia of the near nodes within the layer. This is as
    accurate as the displacements; their derivative would lose an order (Wheeler, SIAM J. Numer.
    Anal. 11, 1974, for the flux at a node). At either end of the pillar it is the force applied
    there; it tends to the joint's traction towards a joint, which is read where a section is on it.
    """
    cell, order = body.mesh.cell, body.order
    y = body.corners[layer][:, :, axis(body.dim)]
    near, thickness = y.min(), np.ptp(y)
    levels = np.sort(basix_versions.quadrature("interval", *mass_rule(order))[0][:, 0])
    basis = poly.polyfit(levels, np.eye(levels.size), order)
    point, x, volume = quadrature_in(body, layer, *stiffness_rule(cell, order))
    local = (x[:, axis(body.dim)] - near) / thickness
    slope = poly.polyval(local, poly.polyder(basis)[:, 0]) / thickness
    elastic, viscous = _stress_rows(body, materials, point, volume * slope)
    point, x, volume = quadrature_in(body, layer, *mass_rule(order))
    level = np.abs(((x[:, axis(body.dim)] - near) / thickness)[:, None] - levels).argmin(axis=1)
    running = poly.polyint(basis)
    upto = -poly.polyval((place - near) / thickness, running)
    whole = poly.polyval(1.0, running)
    upto[0] += whole[0]
    density = np.array([m.density for m in materials])[body.material[point.cell]]
    mass = (density * volume * (upto / whole)[level])[:, None] * point.basis
    return elastic, viscous, _sums(body, point, per_component(mass, section_directions(body)))


def _by_stress(body: Body, materials: list[Material], place: float) -> tuple[csr_matrix, ...]:
    """Return a section's force as the integral of the stress over it, by Gauss points."""
    at, weight = np.polynomial.legendre.leggauss(PER_SIDE)
    low, high = body.corners.min(axis=(0, 1)), body.corners.max(axis=(0, 1))
    across = [d for d in range(body.dim) if d != axis(body.dim)]
    grids = np.meshgrid(*[(low[d] + high[d] + (high[d] - low[d]) * at) / 2 for d in across])
    x = np.full((grids[0].size, body.dim), float(place))
    x[:, across] = np.column_stack([g.ravel() for g in grids])
    shares = np.meshgrid(*[weight * (high[d] - low[d]) / 2 for d in across])
    area = body.section.extent * np.prod([s.ravel() for s in shares], axis=0)
    which, cell = cells_at(body, x)
    share = area[which] / np.bincount(which, minlength=len(x))[which]
    point = places_in(body, cell, x[which])
    elastic, viscous = _stress_rows(body, materials, point, -share)
    return elastic, viscous, csr_matrix(elastic.shape)


def _stress_rows(
    body: Body, materials: list[Material], point: Places, weight: np.ndarray
) -> tuple[csr_matrix, csr_matrix]:
    """Return the weighted sum of the stresses on the section, as rows [directions, freedoms]: from
    u, and from its rate by the rock's dashpots."""
    eta = np.array([m.time_constant for m in materials])[body.material[point.cell]]
    traction = weight[:, None, None] * section_tractions(body, materials, point)
    return _sums(body, point, traction), _sums(body, point, eta[:, None, None] * traction)


def section_directions(body: Body) -> np.ndarray:
    """Return the components of the motion along y, then x, then z."""
    return np.array([0] if body.section.components == 1 else [1, 0, 2][: body.section.components])


def section_tractions(body: Body, materials: list[Material], point: Places) -> np.ndarray:
    """Return sigma_y, then sigma_xy and sigma_zy, as weights [directions, n, nodes per cell,
    components] of the motion, tension positive."""
    size = body.dim, body.section.components
    moduli = np.array([elastic_moduli(m, *size) for m in materials])
    of_section = moduli[:, section_directions(body), axis(body.dim)][body.material[point.cell]]
    return np.einsum("ndcj,nkj->dnkc", of_section, point.gradient)


def _sums(body: Body, point: Places, weights: np.ndarray) -> csr_matrix:
    """Return the sums of weights [directions, n, nodes, components] over all points, a row each."""
    return matrix_of(body, np.zeros(point.cell.size, dtype=np.int64), point.cell, weights, 1)
