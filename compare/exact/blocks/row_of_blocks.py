"""Rows of rigid blocks, exact in time: the equations of the rigid-block engine.

The row of `system` that a pillar's blocks make, in one dimension or, where it moves across its axis
or turns, in three; solved by matrix exponentials (`linear`). Contact j, from the start's face
(j = 0) over the joints to the end's (j = N), is between the bodies j - 1 and j. The ends have no
contact (free), a dashpot Z A on the block (quiet, Guo & Li 2002, equation 9), a dashpot Z A on a
face without mass behind half a block 2k (matched), or half a block of rock to a wall (fixed).

Without dashpots and with free ends the axial modes are omega_n = 2 sqrt(k/m) sin(n pi / 2N) of
shape cos(n pi (j - 1/2) / N), j = 1..N; Kelvin-Voigt dashpots are proportional and damp each mode
at the rate eta omega_n^2 / 2 (Brillouin, Wave Propagation in Periodic Structures, 1946).

Its only error is round-off, bounded by the difference from a perturbed twin solution.

Valid for loads of any direction, eccentricity or couple, shaken bases, soft layers, segments,
dashpots, mass-proportional damping, any ends, gravity and prestress; no joint opens, slips or
softens.
"""

from typing import Any

import numpy as np
import xarray as xr
from scipy.sparse.linalg import spsolve

from jointwave.cases.effects import is_spatial
from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.histories import Step
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.contact_points import face_points
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.sampling import interpolation, sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.system import (
    BlockSystem,
    Contacts,
    first_order,
    relative,
    resistance,
)
from jointwave.compare.exact.conditions import DAMPED, LAYERS, drive, holds, static_stress
from jointwave.compare.exact.linear import bound, twins
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

Waves = dict[str, np.ndarray]
MOST_BLOCKS = {1: 2000, 3: 500}
HELD = (
    "reversed load",
    "segments",
    "scatter",
    "gravity",
    "prestress",
    "mass damping",
    "fixed start",
    *DAMPED,
    *LAYERS,
)


def applies(scene: Scene) -> Answer:
    """Return whether the scene's chain of rigid blocks is linear and not too long."""
    return holds(scene, HELD, _too_many(scene, 1))


def applies_in_space(scene: Scene) -> Answer:
    """Return whether the scene's row of blocks is spatial, linear and not too long."""
    p = calibrate(scene)
    if not is_spatial(scene):
        return Answer("the motion is axial: see lattice")
    return holds(
        scene,
        ("spatial motion", *HELD),
        (p.friction is not None or p.cohesion is not None, "a joint can slip"),
        (scene.motion.rotation == "finite", "rotations are finite"),
        _too_many(scene, 3),
    )


def _too_many(scene: Scene, dim: int) -> tuple[bool, str]:
    most = MOST_BLOCKS[dim]
    many = f"more than {most:,} blocks: the matrix exponential is dense"
    return scene.block_count > most, many


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's row of blocks; in space also shear
    and rotation. They are the response to the drive, that to sudden gravity, and the initial state.
    """
    one, times = system_of(scene), sample_times(scene)
    states = twins(one.matrix, one.load, drive(scene), times)
    states += twins(one.matrix, one.steady, Step(1.0), times)
    found, twin = (receivers(scene, one, x) for x in states)
    return result(scene, (IN_SPACE if is_spatial(scene) else AXIAL).name, found, twin)


def result(
    scene: Scene, name: str, found: Waves, twin: Waves, known: int | None = None, **about: Any
) -> xr.Dataset:
    """Return waveforms as the result of a solver, with the bounds that their twins give.

    known : number of samples before these diverge.
    """
    errors = {key: bound(x[..., :known], twin[key][..., :known]) for key, x in found.items()}
    about |= {key: x if x.ndim == 2 else x.swapaxes(1, 2) for key, x in found.items()}
    return dataset(scene, name, sample_times(scene), errors=errors, **about)


def system_of(scene: Scene) -> BlockSystem:
    """Return the first-order form of a scene's row."""
    own, base, p = own_freedoms(scene), None, calibrate(scene)
    mass, contacts = bodies(scene)
    if scene.shakes_base:
        base = np.zeros(mass.shape)
        base[p.block_count] = np.array([*scene.load.direction, 0.0, 0.0, 0.0])[own]
    return first_order(
        mass,
        contacts,
        push=drive_vector(scene)[own],
        base=base,
        alpha=p.mass_damping or 0.0,
        start=_at_start(scene, contacts),
        one_sided=1 + np.flatnonzero(~p.tension),
    )


def own_freedoms(scene: Scene) -> list[int]:
    """Return which of (u_x, u_y, u_z, theta_x, theta_y, theta_z) the blocks of a scene have."""
    if not is_spatial(scene):
        return [1]
    return list(range(3 if scene.motion.rotation == "none" else 6))


def bodies(scene: Scene, held: bool = False) -> tuple[np.ndarray, Contacts]:
    """Return the masses of the blocks, the start's face and the end's face, [N + 2, freedoms], and
    the contacts, those of the faces with the ground last; without slip, opening and softening.

    held : as the row stands under gravity, its ends fixed where they bear it, else free.
    """
    p, own = calibrate(scene), own_freedoms(scene)
    n = p.block_count
    kinds = [str(scene.ends.start), str(scene.ends.end)]
    if held:
        bears = (kind == "fixed" or b for kind, b in zip(kinds, scene.bears, strict=True))
        kinds = ["fixed" if one else "free" for one in bears]
    rocks = p.at_start, p.at_end
    start, end = map(_end, kinds, rocks)
    springs = np.stack([p.stiffness, p.shear_stiffness], axis=1)
    etas = np.zeros(n - 1) if p.joint_time_constant is None else p.joint_time_constant
    springs, dashpots = (
        np.concatenate([[a], joints, [b]])
        for a, joints, b in zip(start, (springs, etas[:, None] * springs), end, strict=True)
    )
    masses = np.full(n, p.block_mass) if p.masses is None else p.masses
    inertia = np.array([p.inertia_across, p.inertia_along, p.inertia_across])
    blocks = np.concatenate([np.tile(masses, (3, 1)).T, np.tile(inertia, (n, 1))], axis=1)[:, own]
    matched = np.flatnonzero([kind == "matched" for kind in kinds])
    faces = np.full((2, len(own)), np.inf)
    faces[matched] = 0.0
    y, pairs = p.contact_y, np.stack([np.r_[n, :n], np.r_[:n, n + 1]], axis=1)
    along = y[:, None] - np.concatenate([p.centre_y, y[[0, -1]]])[pairs]
    axis = np.array([[0.0, 1.0, 0.0]]) if len(own) > 1 else np.ones((1, 1))
    x, z, area = face_points(
        scene.pillar.side, scene.joints.contact_points, scene.joints.point_rule
    )
    second = np.diag([area @ x**2, 0.0, area @ z**2])
    behind = np.array([[one.impedance, one.shear_impedance] for one in rocks])[matched]
    ground = np.stack([n + matched, np.full(len(matched), OUTSIDE)], axis=1)
    count = n + 1 + len(matched)
    contacts = Contacts(
        blocks=np.concatenate([pairs, ground]),
        arm=np.concatenate([along, np.zeros(ground.shape)])[..., None] * axis,
        normal=np.tile(axis, (count, 1)),
        area=np.full(count, p.area),
        second=np.tile(second if len(own) > 1 else 0.0, (count, 1, 1)),
        springs=np.concatenate([springs, 0 * behind]),
        dashpots=np.concatenate([dashpots, behind]),
    )
    return np.concatenate([blocks, faces]), contacts


def _end(kind: str, rock: JointedRock) -> tuple[np.ndarray, np.ndarray]:
    """Return the springs and the dashpots of the contact at an end, normal and shear."""
    springs = {
        "matched": (2 * rock.regular_stiffness, 2 * rock.regular_shear_stiffness),
        "fixed": (rock.wall_stiffness, rock.wall_shear_stiffness),
    }
    if kind not in springs:
        Z = np.array([rock.impedance, rock.shear_impedance])
        return 0 * Z, Z if kind == "quiet" else 0 * Z
    own = np.array(springs[kind])
    return own, (rock.time_constant or 0.0) * own


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


def _at_start(scene: Scene, contacts: Contacts) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the displacement of the blocks (m) and the forces of the contacts (N, N m) before the
    load, at rest under static gravity, and the acceleration (m/s2) under sudden gravity.

    Quiet and matched ends that bear the weight exert what they would if they were fixed.
    """
    own, gravity = own_freedoms(scene), scene.gravity
    mass, held = bodies(scene, held=True)
    count, c = len(mass) - 2, len(own)
    fall, pressed = np.zeros(6), np.zeros(6)
    pressed[1] = static_stress(scene) * scene.pillar.area
    if gravity is not None:
        fall[:3] = gravity.acceleration * np.array(gravity.direction)
    initial, sections = np.zeros(c * len(contacts.area)), slice(c * (count + 1))
    initial[sections] = np.tile(pressed[own], count + 1)
    sinks = np.tile(fall[own], count)
    if gravity is None or not sinks.any() or not (gravity.static or any(scene.bears)):
        return 0 * sinks, initial, sinks
    B, masses = relative(held, *mass.shape)[:, : c * count], mass[:count].ravel()
    D = resistance(held, held.springs, c)
    rest = spsolve((B.T @ D @ B).tocsc(), masses * sinks)
    borne = -(D @ (B @ rest))
    if gravity.static:
        initial[sections] += borne
        return rest, initial, 0 * sinks
    start, end = scene.bears
    borne[c:-c] = 0.0
    borne[:c] *= start
    borne[-c:] *= end
    initial[sections] += borne
    return 0 * rest, initial, sinks + B.T @ borne / masses


def contact_forces(
    one: BlockSystem, states: np.ndarray, drive: np.ndarray | float = 0.0
) -> np.ndarray:
    """Return the forces of contacts [..., k] in states [..., m] under a drive [...], N and N m,
    compression positive."""
    strains, count, own = states @ one.strains.T, len(one.initial), one.one_sided
    forces = strains @ one.resists.T + np.multiply.outer(drive, one.direct) + one.initial
    springs = strains[..., :count] @ one.resists[own, :count].T + one.initial[own]
    forces[..., own] = np.where(springs < 0, 0.0, np.maximum(forces[..., own], 0.0))
    return forces


def receivers(scene: Scene, one: BlockSystem, states: np.ndarray) -> Waves:
    """Return stress (Pa), velocity (m/s) and displacement (m) [receivers, n] of a row in states
    [n, m]; in space these along each axis [receivers, 3, n], shear and rotation (rad).

    Stress is interpolated between the start, the contacts and the end; velocity and displacement
    between the block centres.
    """
    (sections, points), c = reads(scene), len(own_freedoms(scene))
    forces = contact_forces(one, states, drive(scene).value(sample_times(scene)))
    waves = [
        (matrix @ x.T).reshape(-1, c, len(states))
        for matrix, x in (
            (sections, forces[:, : sections.shape[1]]),
            (points, states @ one.velocity.T),
            (points, states @ one.displacement.T + one.rest),
        )
    ]
    if c == 1:
        return dict(
            zip(("stress", "velocity", "displacement"), (x[:, 0] for x in waves), strict=True)
        )
    forces, rate, moved = waves
    turned = moved[:, 3:] if c == 6 else 0 * moved
    along = {"velocity": rate[:, :3], "displacement": moved[:, :3], "rotation": turned}
    return {"stress": forces[:, 1], "shear": forces[:, [0, 2]], **along}


def reads(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return the linear interpolations from the forces of contacts to tractions in sections, and
    from the motion of blocks to that of points, as matrices."""
    p, record, found = calibrate(scene), scene.record, []
    for nodes, places in ((p.contact_y, record.stress), (p.centre_y, record.velocity)):
        left, right, weight = interpolation(nodes, places)
        matrix, i = np.zeros((len(places), len(nodes))), np.arange(len(places))
        matrix[i, left] += 1 - weight
        matrix[i, right] += weight
        found.append(np.kron(matrix, np.eye(len(own_freedoms(scene)))))
    return found[0] / p.area, found[1]


AXIAL = Solver(
    name="lattice",
    rock=Rock.RIGID_BLOCKS,
    label="rigid blocks, exact",
    line=thin("#00349a", 9, (0, 4)),
    applies=applies,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks"}},
)
IN_SPACE = Solver(
    name="spatial-lattice",
    rock=Rock.RIGID_BLOCKS,
    dimension=3,
    label="blocks in space, exact",
    line=thin("#00349a", 9, (0, 9)),
    applies=applies_in_space,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks in space"}},
)
