"""Rigid blocks with linear contacts and dashpots in the plane, exactly in time.

    M u'' + C u' + K u = F(t),   degrees of freedom (u, v, phi) of one block after the other,

K from the relative motion at the points of each contact, C from dashpots at two Gauss points of
each edge. F is a cubic between its
samples, so that on each of its pieces the motion is an entire function of time: the error of its
Taylor series to the order ORDER, over steps of at most STEP / omega, omega a bound on the highest
frequency, is below round-off (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
1993, I.8). The only error is that of the cubics against F.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import bmat, csr_array, identity

from jointwave.cases.material.block_stiffness import jump
from jointwave.cases.material.contact_points import ContactPoints, points_of
from jointwave.cases.material.rock_mass import Stiffness
from jointwave.cases.partition.blocks import Contacts

ORDER = 24
STEP = 2.0


class RigidSystem(NamedTuple):
    """Masses [3 N] (kg, kg m2), stiffness and viscosity [3 N, 3 N], each per m of thickness."""

    masses: np.ndarray
    stiffness: csr_array
    viscosity: csr_array

    @property
    def highest(self) -> float:
        """A bound on the highest frequency and on the fastest decay, rad/s: Gershgorin's discs of
        the matrices scaled by the roots of the masses."""
        root = 1 / np.sqrt(self.masses)
        sums = [
            float((abs(x).multiply(root[:, None]).multiply(root)).sum(axis=1).max())
            for x in (self.stiffness, self.viscosity)
        ]
        return sums[0] ** 0.5 + sums[1]


class Points(NamedTuple):
    """Points of edges: block [p], arm from its centroid [p, 2] (m), place [p, 2] (m), unit normal
    [p, 2], length represented by each [p] (m)."""

    block: np.ndarray
    arm: np.ndarray
    place: np.ndarray
    normal: np.ndarray
    length: np.ndarray


def points_on(
    centroid: np.ndarray, block: np.ndarray, start: np.ndarray, end: np.ndarray, normal: np.ndarray
) -> Points:
    """Return two Gauss points on each edge [e] of a block."""
    x, w = points_of("gauss", 2)
    edge = np.repeat(np.arange(len(block)), 2)
    share = np.tile(x, len(block))[:, None]
    place = start[edge] * (1 - share) + end[edge] * share
    length = np.hypot(*(end - start).T)[edge] * np.tile(w, len(block))
    own = block[edge]
    return Points(own, place - centroid[own], place, normal[edge], length)


def stiffness_of(
    count: int, contacts: Contacts, points: ContactPoints, stiffness: Stiffness
) -> csr_array:
    """Return K of contacts of `count` blocks, from the relative motion at their points."""
    blocks, normal = contacts.blocks[points.contact], contacts.normal[points.contact]
    total = 0
    for axis, k in ((normal, stiffness.normal), (_left(normal), stiffness.shear)):
        i, j = (jump(axis, points.arm[:, side]) for side in (0, 1))
        rows = np.concatenate([-i, j], axis=1)
        total = total + _assembled(rows, blocks, k[points.contact] * points.length, count)
    return total


def viscosity_of(points: Points, impedance: np.ndarray, count: int) -> csr_array:
    """Return C of normal and tangential dashpots, impedance [p, 2], Pa s/m."""
    total = 0
    for axis, Z in ((points.normal, impedance[:, 0]), (_left(points.normal), impedance[:, 1])):
        rows = jump(axis, points.arm)
        total = total + _assembled(rows, points.block[:, None], Z * points.length, count)
    return total


def forces_of(points: Points, tractions: np.ndarray, count: int) -> np.ndarray:
    """Return F [n, 3 count] of tractions [n, p, 2], Pa."""
    force = tractions * points.length[:, None]
    moment = points.arm[:, 0] * force[..., 1] - points.arm[:, 1] * force[..., 0]
    each = np.concatenate([force, moment[..., None]], axis=-1)
    total = np.zeros((count, len(tractions), 3))
    np.add.at(total, points.block, np.moveaxis(each, 1, 0))
    return np.moveaxis(total, 0, 1).reshape(len(tractions), -1)


def motion(
    system: RigidSystem, forces: np.ndarray, interval: float, stride: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return displacements and velocities [n, 3 N] from rest at every `stride`-th sample of the
    forces [k, 3 N], which are `interval` (s) apart."""
    from scipy.interpolate import CubicSpline

    pieces = CubicSpline(interval * np.arange(len(forces)), forces).c[::-1]
    parts = int(np.ceil(interval * system.highest / STEP))
    h, N, matrix = interval / parts, len(system.masses), _first_order(system)
    x = np.zeros(2 * N)
    found = [x]
    for n in range(len(forces) - 1):
        for part in range(parts):
            polynomial = _shifted(pieces[:, n], part * h) * (h ** np.arange(4))[:, None]
            driven, term = polynomial / system.masses, x
            for k in range(ORDER):
                term = matrix @ term
                if k < len(driven):
                    term[N:] += driven[k]
                term *= h / (k + 1)
                x = x + term
        if (n + 1) % stride == 0:
            found.append(x)
    displacement, velocity = np.split(np.array(found), 2, axis=1)
    return displacement, velocity


def _first_order(system: RigidSystem) -> csr_array:
    """Return A of x' = A x + b for x = (u, u') [6 N, 6 N]."""
    own = 1 / system.masses[:, None]
    moves = identity(len(own), format="csr")
    rows = [[None, moves], [-system.stiffness.multiply(own), -system.viscosity.multiply(own)]]
    return csr_array(bmat(rows, format="csr"))


def _shifted(coefficients: np.ndarray, s: float) -> np.ndarray:
    """Return the coefficients [4, m], lowest first, of a cubic about s."""
    a, b, c, d = coefficients
    return np.array([a + s * (b + s * (c + s * d)), b + s * (2 * c + 3 * s * d), c + 3 * s * d, d])


def _assembled(rows: np.ndarray, blocks: np.ndarray, weights: np.ndarray, count: int) -> csr_array:
    """Return the sum of weight row^T row over points in the freedoms of blocks [p, b]."""
    column = (3 * blocks[:, :, None] + np.arange(3)).reshape(len(rows), -1)
    place = np.repeat(np.arange(len(rows)), column.shape[1])
    B = csr_array((rows.ravel(), (place, column.ravel())), shape=(len(rows), 3 * count))
    return csr_array(B.T @ B.multiply(weights[:, None]))


def _left(normal: np.ndarray) -> np.ndarray:
    return np.stack([-normal[:, 1], normal[:, 0]], axis=1)
