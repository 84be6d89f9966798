"""Rigid blocks with small motion and linear contacts as first-order systems x' = A x + b f + g, in
one, two or three dimensions d.

A block moves by (u, theta) of its centroid, with d displacements and 0, 1 or 3 rotations; a point
at the arm a moves by u + theta x a. A contact of bodies i and j has at its centroid the relative
motion r of j minus i, and exerts the force and moment F on j. Springs K_n and K_s (Pa/m) over its
area A with second moments S give the stiffness

    D = [[A k, 0], [0, sum_ab S_ab E_a^T k E_b]],   k = K_s 1 + (K_n - K_s) n n^T,

E_a theta = theta x e_a, and dashpots the viscosity V likewise. With r = B X, X the motion of all
bodies, and mass-proportional damping alpha

    M u'' + alpha M u' = [B^T F]_u + M gravity,   F = -(D r + V r') + push f + initial
    0 = [B^T F]_w                                 on a massless face

while a wall is at rest, or moves with the base. A no-tension joint of a chain exerts no force while
its spring, or spring and dashpot together, are in tension (Guo & Li 2002, equation 10).

States are relative to the initial one and scaled by the square roots of masses, displacements also
by the highest frequency of a long chain, so that the entries of A have similar size. Scales are
powers of two, so that blocks that move together have exactly zero strain.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np
from scipy.sparse import bsr_array, csr_array, diags, eye, hstack, vstack

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.geometry.measure import along_and_across

#: e_k x e_i as [i, :, k]: displacement at the end of an arm along i by a rotation about k.
TURN = np.cross(np.eye(3)[None], np.eye(3)[:, None]).swapaxes(1, 2)


class Contacts(NamedTuple):
    """Plane contacts of bodies i and j.

    blocks : int array [c, 2]; OUTSIDE is the ground, at rest. arm : [c, 2, d], from the centroids
    of i and j to that of the contact, m. normal : [c, d]. area : [c], m^(d-1). second : [c, d, d],
    second moments of its points about its centroid, m^(d+1). springs, dashpots : [c, 2], normal and
    shear, or tensors [c, d, d], Pa/m and Pa s/m.
    """

    blocks: np.ndarray
    arm: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    second: np.ndarray
    springs: np.ndarray
    dashpots: np.ndarray


def contacts_of(
    blocks: Blocks,
    facets: Facets,
    springs: np.ndarray,
    dashpots: np.ndarray,
    bending: np.ndarray | float = 1.0,
    shift: np.ndarray | float = 0.0,
) -> Contacts:
    """Return facets of blocks as contacts; those on the boundary are contacts with the ground.

    springs, dashpots : see `Contacts`. bending : share of the second moments that the points of
    each contact carry [c]. shift : offset of blocks j, m [d].
    """
    i, j = facets.blocks.T
    arms = [facets.centroid - blocks.centroid[i], facets.centroid - blocks.centroid[j] - shift]
    second = np.broadcast_to(bending, i.shape)[:, None, None] * facets.second_moment
    arm = np.stack(arms, axis=1)
    return Contacts(facets.blocks, arm, facets.normal, facets.area, second, springs, dashpots)


class BlockSystem(NamedTuple):
    """First-order form of blocks with n degrees of freedom in m states: displacements and
    velocities of blocks, displacements of massless faces, and that of the base.

    mass : float array [n], kg or kg m2. stiffness : sparse [n, n], with all other bodies at rest.
    free : sparse [m, m] (1/s), A without the contacts.
    load, steady : b, float array [m] or, for several loads, [loads, m]; and g [m].
    displacement, velocity : sparse [n, m], from the state to the blocks' motion; m, m/s (rad,
        rad/s). rest : float array [n], their displacement at the start.
    strains : sparse [2 k, m], relative displacements and velocities of the contacts.
    resists : sparse [k, 2 k], their forces on bodies j (N, N m) per strain.
    direct, initial : float arrays [k], contact forces by a unit drive and at the start.
    driven, moves : sparse [m, n] and [m, k], rate of the state per force on the blocks' freedoms
        and per contact force.
    one_sided : int array, the no-tension contacts of a chain.
    """

    mass: np.ndarray
    stiffness: csr_array
    free: csr_array
    load: np.ndarray
    steady: np.ndarray
    displacement: csr_array
    velocity: csr_array
    rest: np.ndarray
    strains: csr_array
    resists: csr_array
    direct: np.ndarray
    initial: np.ndarray
    driven: csr_array
    moves: csr_array
    one_sided: np.ndarray

    @property
    def forces(self) -> csr_array:
        """Contact forces per state, sparse [k, m], N or N m."""
        return self.resists @ self.strains

    @property
    def matrix(self) -> csr_array:
        """A, sparse [m, m], 1/s."""
        return self.free + self.moves @ self.forces


def carried(arm: np.ndarray, freedoms: int) -> np.ndarray:
    """Return the matrices [p, f, f] from the motion of bodies to the motion at arms [p, d], m."""
    dim = arm.shape[1]
    found = np.tile(np.eye(freedoms), (len(arm), 1, 1))
    found[:, :dim, dim:] = np.einsum("pi,ijk->pjk", arm, _turn(dim, freedoms))
    return found


def relative(contacts: Contacts, bodies: int, freedoms: int) -> csr_array:
    """Return B, the contacts' relative motions per motion of the bodies, sparse."""
    i, j = (carried(contacts.arm[:, side], freedoms) for side in (0, 1))
    blocks = np.where(contacts.blocks == OUTSIDE, bodies, contacts.blocks)
    matrices = np.stack([-i, j], axis=1).reshape(-1, freedoms, freedoms)
    first, shape = 2 * np.arange(len(blocks) + 1), (len(blocks), bodies + 1)
    found = bsr_array((matrices, blocks.ravel(), first), shape=np.multiply(shape, freedoms))
    return csr_array(found)[:, : bodies * freedoms]


def resistance(contacts: Contacts, values: np.ndarray, freedoms: int) -> csr_array:
    """Return D or V of contacts, sparse; values : see `Contacts`, Pa/m or Pa s/m."""
    count, dim = contacts.normal.shape
    k = values if values.ndim == 3 else along_and_across(contacts.normal, values)
    each, turn = np.zeros((count, freedoms, freedoms)), _turn(dim, freedoms)
    each[:, :dim, :dim] = contacts.area[:, None, None] * k
    each[:, dim:, dim:] = np.einsum("cab,aik,cij,bjl->ckl", contacts.second, turn, k, turn)
    return csr_array(bsr_array((each, np.arange(count), np.arange(count + 1))))


def first_order(
    mass: np.ndarray,
    contacts: Contacts,
    push: np.ndarray | None = None,
    base: np.ndarray | None = None,
    alpha: float = 0.0,
    start: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None,
    one_sided: np.ndarray | None = None,
    axes: csr_array | None = None,
) -> BlockSystem:
    """Return the first-order form of bodies.

    mass : [bodies, f], per degree of freedom, kg and kg m2; 0 for massless faces, which touch
        blocks and the ground by dashpots, and infinite for walls. Blocks come first.
    push : forces of a unit drive on the first contact [f], N and N m.
    base : motion of the walls [bodies, f] if the drive is the velocity of the base.
    alpha : of mass-proportional damping, 1/s.
    start : initial displacement of the blocks [n] and contact forces [k], and gravity's
        acceleration [n] that these do not balance.
    one_sided : no-tension contacts.
    axes : sparse matrix from motion with rotations about principal axes to motion with rotations
        about the contacts' axes; None if they are the same.
    """
    (bodies, c), own = mass.shape, mass.ravel()
    B = relative(contacts, bodies, c) if axes is None else relative(contacts, bodies, c) @ axes
    D, V = (resistance(contacts, x, c) for x in (contacts.springs, contacts.dashpots))
    q, f = np.flatnonzero(np.isfinite(own) & (own > 0)), np.flatnonzero(own == 0)
    (count, size), n, masses = B.shape, len(q), own[q]
    moved = np.zeros((size, 1)) if base is None else base.reshape(-1, 1)
    every, still = csr_array(eye(size)), csr_array((size, n))
    position = csr_array(hstack([every[:, q], still, every[:, f], moved]))
    velocity = csr_array(hstack([still, every[:, q], 0 * every[:, f], 0 * moved]))
    pulled = -B[:, f].T @ (D @ B @ position + V @ B @ velocity)
    dashpots = (B[:, f].T @ V @ B[:, f]).toarray()
    rates = csr_array(np.linalg.solve(dashpots, pulled.toarray()))
    velocity = velocity + every[:, f] @ rates
    direct = -(V @ B @ moved)[:, 0]
    direct[:c] += 0.0 if push is None else push
    rest, initial, sinks = start or (np.zeros(n), np.zeros(count), np.zeros(n))
    driven = vstack([csr_array((n, n)), diags(1 / masses), csr_array((len(f) + 1, n))])
    free = vstack([velocity[q], -alpha * velocity[q], rates, 0 * position[:1]])
    load = driven @ (B[:, q].T @ direct)
    load[-1] = base is not None
    steady = np.concatenate([np.zeros(n), sinks, np.zeros(len(f) + 1)])
    K, roots = B[:, q].T @ D @ B[:, q], np.sqrt(masses)
    rate = sqrt(2 * (K.diagonal() / masses).max()) or 1.0  # K.diagonal() = 2 k in a chain
    scale = np.concatenate([rate * roots, roots, rate * np.resize(roots[:c], len(f) + 1)])
    scale = np.exp2(np.round(np.log2(scale)))
    to, back = csr_array(diags(scale)), csr_array(diags(1 / scale))
    return BlockSystem(
        mass=masses,
        stiffness=K,
        free=to @ free @ back,
        load=scale * load,
        steady=scale * steady,
        displacement=position[q] @ back,
        velocity=velocity[q] @ back,
        rest=rest,
        strains=csr_array(vstack([B @ position, B @ velocity])) @ back,
        resists=csr_array(hstack([-D, -V])),
        direct=direct,
        initial=initial,
        driven=to @ driven,
        moves=to @ driven @ B[:, q].T,
        one_sided=np.zeros(0, dtype=int) if one_sided is None else one_sided,
    )


def _turn(dim: int, freedoms: int) -> np.ndarray:
    """Return the displacement at the ends of arms by rotations, [d, d, rotations]."""
    return TURN[:dim, :dim, 3 - (freedoms - dim) :]
