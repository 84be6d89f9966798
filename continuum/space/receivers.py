"""Receivers: motion and stress at any place along the pillar."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial as poly
from scipy.sparse import csr_matrix, vstack

from continuum.space import compat
from continuum.space.body import Body, along, axis
from continuum.space.elasticity import Material, lame_constants, stiffness_rule
from continuum.space.evaluation import (
    Places,
    at_reference,
    cells_at,
    jacobians,
    matrix_of,
    places_in,
)
from continuum.space.interface import Jumps

NEAR = 1e-9  # of the pillar: when a section is on a joint
PER_SIDE = 8  # Gauss points across a section that the mesh does not follow


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
    share = _shares(which, body.piece[cell])
    at = places_in(body, cell, x[which])
    components, count = body.section.components, len(places)
    rows = [
        matrix_of(body, which, cell, _only(share[:, None] * at.basis, c, components), count)
        for c in range(components)
    ]
    turn = None
    if body.dim > 1:
        gradient = share[:, None, None] * at.gradient
        parts = [_rotation(gradient, about, components) for about in range(3)]
        turn = vstack([matrix_of(body, which, cell, part, count) for part in parts]).tocsr()
    return Points(vstack(rows).tocsr(), turn)


def _shares(which: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """Return the share of each cell [n] in the mean at the point that it is at: pieces that meet
    there count alike, however many of their cells do."""
    pieces = 1 + piece.max(initial=0)
    side, of_cell, cells = np.unique(
        which * pieces + piece, return_inverse=True, return_counts=True
    )
    sides = np.bincount(side // pieces)
    return 1 / (sides[which] * cells[of_cell])


def _only(weights: np.ndarray, component: int, components: int) -> np.ndarray:
    """Return weights [n, nodes] of one component as [n, nodes, components]."""
    found = np.zeros((*weights.shape, components))
    found[:, :, component] = weights
    return found


def _rotation(gradient: np.ndarray, about: int, components: int) -> np.ndarray:
    """Return the weights of half the curl about one axis; in dim 2 only that about z is there."""
    found = np.zeros((*gradient.shape[:2], components))
    one, other = (about + 1) % 3, (about + 2) % 3
    if max(one, other) < components:
        found[:, :, other] += 0.5 * gradient[:, :, one]
        found[:, :, one] -= 0.5 * gradient[:, :, other]
    return found


def sections(
    body: Body, jumps: Jumps | None, materials: list[Material], places: list[float]
) -> Sections:
    """Return how the forces over sections are read."""
    directions = 1 if body.section.components == 1 else body.section.components
    size, count = body.mass.size, len(places)
    parts: list[list[csr_matrix]] = [[], [], []]
    contact = []
    for place in places:
        contact.append(_points_of_joint(body, jumps, place))
        on_joint = is_on_joint(body, place)
        found = _none(directions, size) if on_joint else _section(body, materials, place)
        for part, rows in zip(parts, found, strict=True):
            part.append(rows)
    # One direction of all sections after the other.
    order = np.arange(count * directions).reshape(count, directions).T.ravel()
    elastic, damped, inertia = (
        vstack(part).tocsr()[order] if part else csr_matrix((0, size)) for part in parts
    )
    return Sections(
        elastic,
        damped,
        inertia,
        vstack(contact).tocsr() if contact else csr_matrix((0, 0)),
    )


def _none(directions: int, size: int) -> tuple[csr_matrix, ...]:
    return tuple(csr_matrix((directions, size)) for _ in range(3))


def is_on_joint(body: Body, place: float) -> bool:
    """Return whether a section is on a joint, and reads its traction."""
    y = body.mesh.joints.corners[:, :, axis(body.dim)]
    return bool((np.abs(y - place) <= NEAR * body.length).all(axis=1).any())


def _points_of_joint(body: Body, jumps: Jumps | None, place: float) -> csr_matrix:
    """Return the areas [1, q] of the joint's points, zero where the section is on none."""
    if jumps is None:
        return csr_matrix((1, 0))
    if not is_on_joint(body, place):
        return csr_matrix((1, jumps.weight.size))
    near = np.abs(jumps.x[:, axis(body.dim)] - place) <= NEAR * body.length
    return csr_matrix(np.where(near & jumps.flat, jumps.weight, 0.0))


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
    if follows and body.mesh.cell in ("interval", "quadrilateral", "hexahedron"):
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
    order, lobatto = body.order, (max(2 * body.order - 1, 1), True)
    levels = np.sort(compat.quadrature("interval", *lobatto)[0][:, 0])
    basis = poly.polyfit(levels, np.eye(levels.size), order)
    point, volume, local, thickness = _in_layer(body, layer, *stiffness_rule(body.mesh.cell, order))
    slope = poly.polyval(local, poly.polyder(basis)[:, 0]) / thickness
    elastic, viscous = _stress_rows(body, materials, point, volume * slope)
    point, volume, local, thickness = _in_layer(body, layer, *lobatto)
    level = np.abs(local[:, None] - levels).argmin(axis=1)
    near = body.corners[layer][:, :, axis(body.dim)].min()
    running = poly.polyint(basis)
    upto = -poly.polyval((place - near) / thickness, running)
    whole = poly.polyval(1.0, running)
    upto[0] += whole[0]
    density = np.array([m.density for m in materials])[body.material[point.cell]]
    mass = density * volume * (upto / whole)[level]
    return elastic, viscous, _sums(body, point, mass)


def _in_layer(
    body: Body, layer: np.ndarray, degree: int, lobatto: bool
) -> tuple[Places, np.ndarray, np.ndarray, float]:
    """Return the quadrature points of a layer of cells, their volumes (m3), their heights in the
    layer (0 .. 1) and its thickness (m)."""
    at, weight = compat.quadrature(body.mesh.cell, degree, lobatto)
    everywhere = np.tile(at, (layer.size, 1))
    point = at_reference(body, np.repeat(layer, len(at)), everywhere)
    volume = _volumes(body, point.cell, everywhere) * np.tile(weight, layer.size)
    y = body.corners[layer][:, :, axis(body.dim)]
    thickness = float(y.max() - y.min())
    local = (_heights(body, point.cell, everywhere) - y.min()) / thickness
    return point, volume, local, thickness


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


def _volumes(body: Body, cell: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the rock's volume (m3) per unit of reference cell at points."""
    found = np.linalg.det(jacobians(body.mesh.cell, body.corners[cell], at))
    return body.section.extent * np.abs(found)


def _heights(body: Body, cell: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return y (m) of points in reference coordinates of their cells."""
    shape, _ = compat.tabulate(body.mesh.cell, 1, at)
    return np.einsum("nv,nv->n", shape, body.corners[cell][:, :, axis(body.dim)])


def _stress_rows(
    body: Body, materials: list[Material], point: Places, weight: np.ndarray
) -> tuple[csr_matrix, csr_matrix]:
    """Return the weighted sum of the stresses on the section, sigma_y, then its shear along x and
    z, as rows [directions, freedoms]: from u, and from its rate by the rock's dashpots."""
    eta = np.array([m.time_constant for m in materials])[body.material[point.cell]]
    tractions = section_tractions(body, materials, point)
    rows = [_sum(body, point.cell, weight[:, None, None] * traction) for traction in tractions]
    damped = [
        _sum(body, point.cell, (eta * weight)[:, None, None] * traction) for traction in tractions
    ]
    return vstack(rows).tocsr(), vstack(damped).tocsr()


def section_tractions(body: Body, materials: list[Material], point: Places) -> list[np.ndarray]:
    """Return sigma_y, then sigma_xy and sigma_zy, as weights [n, nodes per cell, components] of
    the motion, tension positive."""
    gradient, of_cell = point.gradient, [materials[m] for m in body.material[point.cell]]
    n, nodes, dim = gradient.shape
    components = body.section.components
    found = [np.zeros((n, nodes, components)) for _ in range(components)]
    if dim == 1:
        modulus = np.array([m.modulus for m in of_cell])[:, None]
        shear = np.array([m.shear_modulus for m in of_cell])[:, None]
        found[0][:, :, along(body.section)] = modulus * gradient[:, :, 0]
        for k, c in enumerate((0, 2)[: components - 1], 1):
            found[k][:, :, c] = shear * gradient[:, :, 0]
        return found
    lame, shear = np.array([lame_constants(m, dim) for m in of_cell]).T[:, :, None, None]
    found[0] += lame * gradient
    found[0][:, :, 1] += 2 * shear[:, :, 0] * gradient[:, :, 1]
    for k, c in enumerate((0, 2)[: components - 1], 1):
        found[k][:, :, c] = shear[:, :, 0] * gradient[:, :, 1]
        found[k][:, :, 1] = shear[:, :, 0] * gradient[:, :, c]
    return found


def _sum(body: Body, cell: np.ndarray, weights: np.ndarray) -> csr_matrix:
    """Return the sum of weights [n, nodes, components] over all points, one row."""
    return matrix_of(body, np.zeros(cell.size, dtype=np.int64), cell, weights, 1)


def _sums(body: Body, point: Places, mass: np.ndarray) -> csr_matrix:
    """Return the weighted sum of the motion at points, along y, then x and z, one row each."""
    components = body.section.components
    order = [0] if components == 1 else [1, 0, 2][:components]
    weights = mass[:, None] * point.basis
    return vstack([_sum(body, point.cell, _only(weights, c, components)) for c in order]).tocsr()
