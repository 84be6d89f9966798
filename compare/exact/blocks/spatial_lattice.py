"""The row of rigid blocks in space, exact in time: the equations of the rigid-block engine.

Stretching, torsion and the two bendings of `spatial`, as first-order systems (`spatial_system`) by
matrix exponentials. The solution is a sum: the response to the load from rest, the static state
under gravity (or the response to suddenly applied gravity), and the state under the prestress. Only
planes that are excited are solved.

Valid for loads of any direction, eccentricity or couple, shaken bases, soft layers, dashpots,
mass-proportional damping, any ends, gravity and prestress; no joint opens, slips or softens.
"""

import numpy as np
import xarray as xr

from cases.effects import is_spatial
from cases.histories import Step
from cases.material.calibrate import calibrate
from cases.sampling import interpolation, sample_times
from cases.schema.scene import Scene
from compare.exact.blocks.lattice import HELD
from compare.exact.blocks.spatial import PLANES, plane, row
from compare.exact.blocks.spatial_system import SpatialSystem, at_rest, system
from compare.exact.conditions import holds, static_stress
from compare.exact.drive import drive
from compare.exact.linear import bound, twins
from compare.solvers.record import BLOCKS, Answer, Kind, Rock, Solver, Words, no, thin
from results.dataset import dataset

MOST_BLOCKS = 500


def applies(scene: Scene) -> Answer:
    """Return whether the scene's row of blocks is spatial, linear and not too long."""
    p = calibrate(scene)
    if not is_spatial(scene):
        return no("the motion is axial: see lattice")
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
        parts = system(plane(blocks, freedoms), push[own], fall[own], shaken)
        found = _receivers(scene, parts, len(own), times)
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


def _receivers(scene: Scene, parts: SpatialSystem, c: int, times: np.ndarray) -> list[np.ndarray]:
    """Return the forces, displacements and velocities [2, receivers, c, n] of one plane and of its
    twin."""
    signal, gravity = drive(scene), scene.gravity
    rows, counts = _rows(scene, parts, c)
    out = np.zeros((2, len(times), len(rows)))
    if parts.load.any():
        out += twins(parts.matrix, parts.load, rows, signal, times)
        sections = _read(_contacts(scene), scene.record.stress, c)
        out[..., : counts[0]] += np.outer(signal.value(times), sections @ parts.direct)
    if parts.gravity.any() and gravity is not None:
        if gravity.static:
            out += rows @ at_rest(parts)
        else:
            out += twins(parts.matrix, parts.gravity, rows, Step(1.0), times)
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
    words=Words(BLOCKS, "blocks in space, exact", "空间块体列（精确解）"),
    line=thin("#00349a", 9, (0, 9), (1.2, 4)),
    applies=applies,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks in space"}},
)
