"""The row of rigid blocks as first-order systems x' = A x + b f(t) + g, one for each `plane`.

With the coordinates X (the blocks' u, the faces' w), the contacts' relative motions r = B X,
stiffness D and viscosity C of the contacts, and alpha of mass-proportional damping

    M u'' + alpha M u' = [B^T F]_u + M gravity,   F = -(D r + C r') + load + prestress
    Z w' = [B^T F]_w                              on a matched end's massless face

while a held face is at rest, or moves with the base. The contact j exerts F_j on its right side;
quiet and matched ends that bear the weight exert, beside, what they would if they were fixed. A
joint of a chain that carries no tension exerts nothing while its spring, or spring and dashpot
together, pull (Guo & Li 2002, equation 10).

States are relative to the initial one, weighted by the roots of masses, displacements also by the
highest frequency of a long chain, so that the entries of A are of similar magnitude; by powers of
two, so that blocks that move together strain nothing to the last bit.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, diags, eye, hstack, vstack

from jointwave.cases.histories import Step
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import interpolation, sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.plane import STRETCHING, plane
from jointwave.compare.exact.conditions import drive, static_stress
from jointwave.compare.exact.linear import twins


class BlockSystem(NamedTuple):
    """The first-order form of one plane: n = N c degrees of freedom of the blocks in m states.

    free : sparse [m, m] (1/s), A without the contacts.
    load, steady : float arrays [m], b of a unit `drive` and g.
    displacement, velocity : sparse [n, m], from the state to the blocks' motion; m, m/s (rad,
        rad/s). rest : float array [n], their displacement at the start.
    strains : sparse [2 (N + 1) c, m], relative displacements and velocities of the contacts.
    resists : sparse [(N + 1) c, 2 (N + 1) c], their forces on the right side (N, N m) per strain.
    direct, initial : float arrays [(N + 1) c], those of a unit drive and those at the start.
    moves : sparse [m, (N + 1) c], rate of the state per force of a contact.
    one_sided : int array, the contacts of a chain that carry no tension.
    """

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
    moves: csr_array
    one_sided: np.ndarray

    @property
    def forces(self) -> csr_array:
        """Forces of the contacts per state, sparse [(N + 1) c, m], N or N m."""
        return self.resists @ self.strains

    @property
    def matrix(self) -> csr_array:
        """A, sparse [m, m], 1/s."""
        return self.free + self.moves @ self.forces


def chain(scene: Scene) -> BlockSystem:
    """Return the first-order form of a scene's axial motion."""
    return system(scene, STRETCHING)


def system(scene: Scene, freedoms: tuple[int, ...]) -> BlockSystem:
    """Return the first-order form of a plane of a scene. A state holds displacements and velocities
    of the blocks, displacements of the matched faces and of the base."""
    own, p, part = list(freedoms), calibrate(scene), plane(scene, freedoms)
    B, D, C, q, f = part.relative, part.stiffness, part.viscosity, part.blocks, part.faces
    n, c, (contacts, count) = len(part.mass), len(own), B.shape
    base, every = np.zeros((count, 1)), csr_array(eye(count))
    if scene.shakes_base:
        base[:c, 0] = np.array([*scene.load.direction, 0.0, 0.0, 0.0])[own]
    still, faces = csr_array((count, n)), every[:, f]
    position = csr_array(hstack([every[:, q], still, faces, base]))
    velocity = csr_array(hstack([still, every[:, q], 0 * faces, 0 * base]))
    pulled = -faces.T @ B.T @ (D @ B @ position + C @ B @ velocity)
    dashpots = (faces.T @ B.T @ C @ B @ faces).toarray() + part.dashpots
    rates = csr_array(np.linalg.solve(dashpots, pulled.toarray()))
    velocity = velocity + faces @ rates
    strains = vstack([B @ position, B @ velocity])
    resists, direct = csr_array(hstack([-D, -C])), -(C @ B @ base)[:, 0]
    direct[:c] += drive_vector(scene)[own]
    rest, initial, sinks = _initial(scene, freedoms)
    others = csr_array((len(f) + 1, contacts))
    pushes = diags(1 / part.mass) @ B[:, q].T
    moves = csr_array(vstack([csr_array((n, contacts)), pushes, others]))
    alpha = p.mass_damping or 0.0
    free = vstack([velocity[q], -alpha * velocity[q], rates, 0 * position[:1]])
    load = moves @ direct
    load[-1] = scene.shakes_base
    steady = np.concatenate([np.zeros(n), sinks, np.zeros(len(f) + 1)])
    roots = np.sqrt(part.mass)
    largest = (pushes @ D @ B[:, q]).diagonal().max()  # twice k / m
    rate = sqrt(2 * largest) or 1.0
    scale = np.concatenate([rate * roots, roots, rate * np.resize(roots[:c], len(f) + 1)])
    scale = np.exp2(np.round(np.log2(scale)))
    to, back = csr_array(diags(scale)), csr_array(diags(1 / scale))
    return BlockSystem(
        free=to @ free @ back,
        load=scale * load,
        steady=scale * steady,
        displacement=position[q] @ back,
        velocity=velocity[q] @ back,
        rest=rest,
        strains=csr_array(strains) @ back,
        resists=resists,
        direct=direct,
        initial=initial,
        moves=to @ moves,
        one_sided=1 + np.flatnonzero(~p.tension),
    )


def drive_vector(scene: Scene) -> np.ndarray:
    """Return the force and moment [6] at the start face's centre under an end stress of 1 Pa."""
    load, vector = scene.load, np.zeros(6)
    if scene.shakes_base:
        return vector
    if load.arm:
        vector[3:] = load.arm * np.array(load.direction)
    else:
        vector[:3] = load.direction
        vector[3:] = np.cross([load.at[0], 0.0, load.at[1]], load.direction)
    return scene.pillar.area * vector


def _initial(scene: Scene, freedoms: tuple[int, ...]) -> tuple[np.ndarray, ...]:
    """Return the displacement of the blocks (m) and the forces of the contacts (N, N m) before the
    load, at rest under static gravity, and the acceleration (m/s2) under sudden gravity."""
    own, gravity, part = list(freedoms), scene.gravity, plane(scene, freedoms, held=True)
    c, B = len(own), part.relative[:, part.blocks]
    fall, pressed = np.zeros(6), np.zeros(6)
    pressed[1] = static_stress(scene) * scene.pillar.area
    if gravity is not None:
        fall[:3] = gravity.acceleration * np.array(gravity.direction)
    initial = np.tile(pressed[own], B.shape[0] // c)
    sinks = np.tile(fall[own], B.shape[1] // c)
    if gravity is None or not sinks.any() or not (gravity.static or any(scene.bears)):
        return 0 * sinks, initial, sinks
    rest = np.linalg.solve((B.T @ part.stiffness @ B).toarray(), part.mass * sinks)
    borne = -part.stiffness @ (B @ rest)
    if gravity.static:
        return rest, initial + borne, 0 * sinks
    start, end = scene.bears
    borne[c:-c] = 0.0
    borne[:c] *= start
    borne[-c:] *= end
    return 0 * rest, initial + borne, sinks + B.T @ borne / part.mass


def contact_forces(
    one: BlockSystem, states: np.ndarray, drive: np.ndarray | float = 0.0
) -> np.ndarray:
    """Return the forces of a chain's contacts [..., N + 1] in states [..., m] under a drive [...],
    N, compression positive."""
    strains, count, own = states @ one.strains.T, len(one.initial), one.one_sided
    springs = strains[..., :count] @ one.resists[:, :count].T + one.initial
    forces = strains @ one.resists.T + np.multiply.outer(drive, one.direct) + one.initial
    forces[..., own] = np.where(springs[..., own] < 0, 0.0, np.maximum(forces[..., own], 0.0))
    return forces


def receivers(
    scene: Scene, one: BlockSystem, states: np.ndarray, drive: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return stress (Pa), velocity (m/s) and displacement (m) [receivers, n] of a chain in states
    [n, m] under a drive [n].

    Stress is interpolated between the start, the contacts and the end; velocity and displacement
    between the block centres.
    """
    sections, points = _read(scene, 1)
    stress = sections @ contact_forces(one, states, drive).T / scene.pillar.area
    moved = points @ (states @ one.displacement.T + one.rest).T
    return stress, points @ (states @ one.velocity.T).T, moved


def response(scene: Scene, freedoms: tuple[int, ...]) -> list[np.ndarray]:
    """Return the forces (N, N m), velocities and displacements (m, rad) at the receivers
    [2, receivers, c, n] of a linear plane and of its twin (`linear.twins`): the response to the
    drive, that to sudden gravity, and the initial state."""
    one, times = system(scene, freedoms), sample_times(scene)
    signal, c = drive(scene), len(freedoms)
    sections, points = _read(scene, c)
    rows = np.concatenate([sections @ one.forces, points @ one.velocity, points @ one.displacement])
    out, force = np.zeros((2, len(times), len(rows))), slice(len(sections))
    for vector, history in ((one.load, signal), (one.steady, Step(1.0))):
        if vector.any():
            out += twins(one.matrix, vector, rows, history, times)
    out[..., force] += np.outer(signal.value(times), sections @ one.direct) + sections @ one.initial
    out[..., len(rows) - len(points) :] += points @ one.rest
    cuts = len(sections) + len(points) * np.arange(2)
    parts = np.split(out, cuts, axis=2)
    return [part.reshape(2, len(times), -1, c).transpose(0, 2, 3, 1) for part in parts]


def _read(scene: Scene, c: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the linear interpolations from contacts to sections and from blocks to points, as
    matrices for c values each."""
    p, record, found = calibrate(scene), scene.record, []
    for nodes, places in ((p.contact_y, record.stress), (p.centre_y, record.velocity)):
        left, right, weight = interpolation(nodes, places)
        matrix, i = np.zeros((len(places), len(nodes))), np.arange(len(places))
        matrix[i, left] += 1 - weight
        matrix[i, right] += weight
        found.append(np.kron(matrix, np.eye(c)))
    return found[0], found[1]
