"""The row of rigid blocks in space, exact in time: the equations of the rigid-block engine.

Stretching, torsion and the two bendings of `spatial`, as first-order systems by matrix
exponentials. The solution is a sum: the response to the load from rest, the static state
under gravity (or the response to suddenly applied gravity), and the state under the prestress. Only
planes that are excited are solved.

Valid for loads of any direction, eccentricity or couple, shaken bases, soft layers, dashpots,
mass-proportional damping, any ends, gravity and prestress; no joint opens, slips or softens.

A plane is x' = A x + b f(t) + g. With the coordinates X (the blocks' u, the faces' w), the
contacts' relative motions r = B X, stiffness D and viscosity C of the contacts, and alpha of
mass-proportional damping

    M u'' + alpha M u' + [B^T (D r + C r')]_u = load + M gravity
    Z w' + [B^T (D r + C r')]_w = 0            on a matched end's massless face

while a held face is at rest, or moves with the base. The contact j exerts -(D r + C r') on its
right side; quiet and matched ends that bear the weight exert, beside, what they would if they were
fixed. States are mass-weighted, and displacements are scaled by w, so that the entries of A
are of similar magnitude.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.effects import is_spatial
from jointwave.cases.histories import Step
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import interpolation, sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.lattice import HELD
from jointwave.compare.exact.blocks.spatial import PLANES, Plane, plane, row
from jointwave.compare.exact.conditions import drive, holds, static_stress
from jointwave.compare.exact.linear import bound, twins
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

MOST_BLOCKS = 500


class SpatialSystem(NamedTuple):
    """The first-order form of one plane, n = N c degrees of freedom of the blocks in m states.

    matrix, load, gravity : A [m, m] (1/s), b [m] of a unit drive, g [m].
    displacement, velocity : float arrays [n, m], from the state to the blocks' motion; m, m/s (rad,
        rad/s). forces, direct : [(N + 1) c, m] and [(N + 1) c], forces (N, N m) of the contacts and
        of the drive at the start on their right side, per state and per unit drive.
    """

    matrix: np.ndarray
    load: np.ndarray
    gravity: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    forces: np.ndarray
    direct: np.ndarray


def system(
    plane: Plane,
    push: np.ndarray,
    gravity: np.ndarray,
    base: np.ndarray | None = None,
    borne: np.ndarray | float = 0.0,
) -> SpatialSystem:
    """Return the first-order form of a plane.

    Parameters
    ----------
    push : float array [c], forces and moments at the centre of the start's face per unit drive.
    gravity : float array [c], acceleration of every block, m/s2.
    base : float array [c], velocity of the start's held face per unit drive; None: at rest.
    borne : float array [(N + 1) c], steady forces of the contacts on their right side, N and N m.
    """
    n, c, q, f = len(plane.mass), len(push), plane.blocks, plane.faces
    B, D, C = plane.relative, plane.stiffness, plane.viscosity
    X, V, driven = _coordinates(plane, base)
    resist = B.T @ (D @ B @ X + C @ B @ V)
    if len(f):
        faces = B[:, f].T @ C @ B[:, f] + np.kron(np.eye(len(f) // c), plane.dashpot)
        V[f] = -np.linalg.solve(faces, resist[f])
        resist += B.T @ C @ B[:, f] @ V[f]
    A = np.concatenate([V[q], -resist[q] / plane.mass[:, None] - plane.mass_damping * V[q], V[f]])
    load = np.concatenate([0 * driven[q], B[:c, q].T @ push - (B.T @ C @ B @ driven)[q]])
    load[n:] /= plane.mass
    weight = np.concatenate([np.zeros(n), np.tile(gravity, n // c)])
    weight[n:] += B[:, q].T @ (borne * np.ones(len(B))) / plane.mass
    direct = -C @ B @ driven
    direct[:c] += push
    forces, size = -(D @ B @ X + C @ B @ V), X.shape[1]
    matrix, b, g = np.zeros((size, size)), np.zeros(size), np.zeros(size)
    matrix[: len(A)], b[: 2 * n], g[: 2 * n] = A, load, weight
    if base is not None:
        b[-1] = 1
    return _scaled(plane, SpatialSystem(matrix, b, g, X[q], V[q], forces, direct))


def _coordinates(plane: Plane, base: np.ndarray | None) -> tuple[np.ndarray, ...]:
    """Return the matrices [(N + 2) c, m] from the state to the coordinates and to their rates, and
    the rates [(N + 2) c] per unit drive. A state holds displacements and velocities of the blocks,
    displacements of the matched faces and of a moving base. Balance gives the faces' rates.
    """
    n, q, f = len(plane.mass), plane.blocks, plane.faces
    count, size = plane.relative.shape[1], 2 * n + len(f) + (base is not None)
    position, velocity, driven = np.zeros((count, size)), np.zeros((count, size)), np.zeros(count)
    position[q, np.arange(n)] = velocity[q, n + np.arange(n)] = 1
    position[f, 2 * n + np.arange(len(f))] = 1
    if base is not None:
        position[: len(base), -1] = driven[: len(base)] = base
    return position, velocity, driven


def at_rest(system: SpatialSystem) -> np.ndarray:
    """Return the state [m] in which the blocks rest under gravity; an end must be fixed.

    The base, if there is one, is at zero: its row of the matrix has no entries.
    """
    moves = system.matrix.any(axis=1)
    state = np.zeros(len(moves))
    own = np.ix_(moves, moves)
    state[moves] = np.linalg.solve(system.matrix[own], -system.gravity[moves])
    return state


def _scaled(plane: Plane, s: SpatialSystem) -> SpatialSystem:
    n, c = len(plane.mass), len(plane.freedoms)
    held = len(s.load) - 2 * n
    roots = np.sqrt(plane.mass)
    rate = 2 * sqrt(np.abs(s.matrix[n : 2 * n, :n]).max()) or 1.0
    scale = np.concatenate([rate * roots, roots, rate * np.resize(roots[:c], held)])
    return SpatialSystem(
        matrix=s.matrix * scale[:, None] / scale,
        load=s.load * scale,
        gravity=s.gravity * scale,
        displacement=s.displacement / scale,
        velocity=s.velocity / scale,
        forces=s.forces / scale,
        direct=s.direct,
    )


def applies(scene: Scene) -> Answer:
    """Return whether the scene's row of blocks is spatial, linear and not too long."""
    p = calibrate(scene)
    if not is_spatial(scene):
        return Answer("the motion is axial: see lattice")
    many = f"more than {MOST_BLOCKS:,} blocks: the matrix exponential is dense"
    return holds(
        scene,
        ("spatial motion", *HELD),
        (p.friction is not None or p.cohesion is not None, "a joint can slip"),
        (scene.motion.rotation == "finite", "rotations are finite"),
        (scene.pillar.block_count > MOST_BLOCKS, many),
    )


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, shear, velocity, displacement and rotation of the scene's row of blocks."""
    times, record = sample_times(scene), scene.record
    blocks, push, fall = row(scene), drive_vector(scene), falling(scene)
    base = np.array([*scene.load.direction, 0.0, 0.0, 0.0]) if scene.shakes_base else None
    forces = np.zeros((2, len(record.stress), 6, len(times)))
    motion, rate = np.zeros((2, 2, len(record.velocity), 6, len(times)))
    for freedoms in PLANES[scene.motion.rotation]:
        own = list(freedoms)
        if not (push[own].any() or fall[own].any() or (base is not None and base[own].any())):
            continue
        shaken = None if base is None else base[own]
        stands = standing(scene, freedoms, fall[own])
        borne = stands.borne if stands else 0.0
        parts = system(plane(blocks, freedoms), push[own], fall[own], shaken, borne)
        found = _receivers(scene, parts, stands, len(own), times)
        for field, part in zip((forces, motion, rate), found, strict=True):
            field[:, :, own] = part
    tractions = forces / scene.pillar.area
    tractions[:, :, 1] += static_stress(scene)
    waves = {
        "stress": tractions[:, :, 1],
        "shear": tractions[:, :, [0, 2]],
        "velocity": rate[:, :, :3],
        "displacement": motion[:, :, :3],
        "rotation": motion[:, :, 3:],
    }
    errors = {name: bound(*pair) for name, pair in waves.items()}
    stress, _ = waves.pop("stress")
    fields = {name: x[0].swapaxes(-1, -2) for name, x in waves.items()}
    return dataset(scene, SOLVER.name, times, stress, **fields, errors=errors)


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


def falling(scene: Scene) -> np.ndarray:
    """Return the acceleration of gravity in all six degrees of freedom, m/s2."""
    gravity, vector = scene.gravity, np.zeros(6)
    if gravity is not None:
        vector[:3] = gravity.acceleration * np.array(gravity.direction)
    return vector


class Standing(NamedTuple):
    """A plane whose ends are held where they bear the weight: its system, its state [m] at rest,
    and the forces [(N + 1) c] (N, N m) of quiet and matched ends there, zero at other contacts."""

    held: SpatialSystem
    state: np.ndarray
    borne: np.ndarray


def standing(scene: Scene, freedoms: tuple[int, ...], fall: np.ndarray) -> Standing | None:
    """Return how a plane stands under gravity, fall [c] in m/s2; None where nothing stands."""
    static = scene.gravity is not None and scene.gravity.static
    if not fall.any() or not (static or any(scene.bears)):
        return None
    held = system(plane(row(scene, held=True), freedoms), 0 * fall, fall)
    state = at_rest(held)
    borne = (held.forces @ state).reshape(-1, len(fall))
    start, end = scene.bears
    borne[1:-1] = 0.0
    borne[[0, -1]] *= [[start], [end]]
    return Standing(held, state, borne.ravel())


def _receivers(
    scene: Scene, parts: SpatialSystem, stands: Standing | None, c: int, times: np.ndarray
) -> list[np.ndarray]:
    """Return the forces, displacements and velocities [2, receivers, c, n] of one plane and of its
    twin."""
    signal, gravity = drive(scene), scene.gravity
    rows, counts = _rows(scene, parts, c)
    out = np.zeros((2, len(times), len(rows)))
    sections = _read(_contacts(scene), scene.record.stress, c)
    if parts.load.any():
        out += twins(parts.matrix, parts.load, rows, signal, times)
        out[..., : counts[0]] += np.outer(signal.value(times), sections @ parts.direct)
    if parts.gravity.any() and gravity is not None:
        if stands and gravity.static:
            out += _rows(scene, stands.held, c)[0] @ stands.state
        else:
            out += twins(parts.matrix, parts.gravity, rows, Step(1.0), times)
            if stands:
                out[..., : counts[0]] += sections @ stands.borne
    fields = np.split(out, np.cumsum(counts), axis=2)
    return [part.reshape(2, len(times), -1, c).transpose(0, 2, 3, 1) for part in fields]


def _rows(scene: Scene, parts: SpatialSystem, c: int) -> tuple[np.ndarray, tuple[int, int]]:
    """Return the matrix from state to receivers, and its numbers of force and displacement rows."""
    record = scene.record
    contacts = _contacts(scene)
    points = _read((contacts[1:] + contacts[:-1]) / 2, record.velocity, c)
    sections = _read(_contacts(scene), record.stress, c) @ parts.forces
    rows = [sections, points @ parts.displacement, points @ parts.velocity]
    return np.concatenate(rows), (len(sections), len(points))


def _contacts(scene: Scene) -> np.ndarray:
    """Return the positions of the N + 1 contacts, m."""
    count = scene.pillar.block_count
    return scene.pillar.length / count * np.arange(count + 1)


def _read(nodes: np.ndarray, places: list[float], c: int) -> np.ndarray:
    """Return the linear interpolation from nodes to places as a matrix, for c values a node."""
    left, right, weight = interpolation(nodes, places)
    matrix, i = np.zeros((len(places), len(nodes))), np.arange(len(places))
    matrix[i, left] += 1 - weight
    matrix[i, right] += weight
    return np.kron(matrix, np.eye(c))


SOLVER = Solver(
    name="spatial-lattice",
    rock=Rock.RIGID_BLOCKS,
    dimension=3,
    label="blocks in space, exact",
    line=thin("#00349a", 9, (0, 9)),
    applies=applies,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks in space"}},
)
