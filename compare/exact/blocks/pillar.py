"""The row of rigid blocks of a pillar, as the masses and contacts of `system`.

Contact j lies between bodies j - 1 and j, from the start's face (j = 0) over the joints to the
end's face (j = N). An end has no contact (free), a dashpot Z A on the block (quiet, Guo & Li 2002,
equation 9), a dashpot Z A on a massless face behind half a block 2k (matched), or half a block of
rock to a wall (fixed).
"""

import numpy as np
from scipy.sparse.linalg import spsolve

from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.contact_points import bending
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks import system


def system_of(scene: Scene) -> system.BlockSystem:
    """Return the first-order form of a scene's row."""
    own, base, p = own_freedoms(scene), None, calibrate(scene)
    mass, contacts = bodies(scene)
    if scene.shakes_base:
        base = np.zeros(mass.shape)
        base[p.block_count] = np.array([*scene.load.direction, 0.0, 0.0, 0.0])[own]
    return system.first_order(
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
    return list(range(scene.block_freedoms)) if scene.is_spatial else [1]


def bodies(scene: Scene, held: bool = False) -> tuple[np.ndarray, system.Contacts]:
    """Return the masses of the blocks, the start's face and the end's face, [N + 2, freedoms], and
    the contacts, those of faces with the ground last; without slip, opening and softening.

    held : the static state under gravity, with ends that bear the weight fixed and others free.
    """
    p, own = calibrate(scene), own_freedoms(scene)
    n, rocks, kinds = p.block_count, (p.at_start, p.at_end), [scene.ends.start, scene.ends.end]
    if held:
        bears = (kind == "fixed" or b for kind, b in zip(kinds, scene.bears, strict=True))
        kinds = ["fixed" if one else "free" for one in bears]
    matched = np.flatnonzero([kind == "matched" for kind in kinds])
    (start, start_eta), (end, end_eta) = map(_end, kinds, rocks)
    joints = np.stack([p.stiffness, p.shear_stiffness], axis=1)
    etas = np.zeros(n - 1) if p.joint_time_constant is None else p.joint_time_constant
    behind = np.array([[one.impedance, one.shear_impedance] for one in rocks])[matched]
    masses = np.full(n, p.block_mass) if p.masses is None else p.masses
    inertia = [np.full(n, x) for x in (p.inertia_across, p.inertia_along, p.inertia_across)]
    faces = np.full((2, 6), np.inf)
    faces[matched] = 0.0
    edges = p.contact_y[[0, -1]]
    y, places = np.append(p.contact_y, edges[matched]), np.append(p.centre_y, edges)
    pairs = np.stack([np.r_[n, :n, n + matched], np.r_[:n, n + 1, 0 * matched + OUTSIDE]], axis=1)
    axis, second = np.ones(1), np.zeros((1, 1))
    if len(own) > 1:
        part = bending(scene.joints.point_rule, scene.joints.contact_points)
        axis, second = np.eye(3)[1], part * p.area**2 / 12 * np.diag([1.0, 0.0, 1.0])
    return np.vstack([np.stack([masses] * 3 + inertia, axis=1), faces])[:, own], system.Contacts(
        blocks=pairs,
        arm=(y[:, None] - places[pairs])[..., None] * axis,
        normal=np.tile(axis, (len(y), 1)),
        area=np.full(len(y), p.area),
        second=np.tile(second, (len(y), 1, 1)),
        springs=np.vstack([start, joints, end, 0 * behind]),
        dashpots=np.vstack([start_eta, etas[:, None] * joints, end_eta, behind]),
    )


def _end(kind: str, rock: JointedRock) -> tuple[np.ndarray, np.ndarray]:
    """Return the springs and dashpots of the contact at an end, normal and shear."""
    if kind in ("free", "quiet"):
        Z = np.array([rock.impedance, rock.shear_impedance])
        return 0 * Z, Z * (kind == "quiet")
    own = 2 * np.array([rock.regular_stiffness, rock.regular_shear_stiffness])
    if kind == "fixed":
        own = np.array([rock.wall_stiffness, rock.wall_shear_stiffness])
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


def _at_start(scene: Scene, contacts: system.Contacts) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the blocks' displacement (m) and the contact forces (N, N m) before the load, at rest
    under static gravity; and the acceleration (m/s2) under sudden gravity.

    Quiet and matched ends that bear the weight exert the reaction of fixed ends.
    """
    own, gravity = own_freedoms(scene), scene.gravity
    mass, held = bodies(scene, held=True)
    count, c = len(mass) - 2, len(own)
    fall, initial = np.zeros(6), np.zeros((len(contacts.area), 6))
    initial[: count + 1, 1] = calibrate(scene).prestress * scene.pillar.area
    initial = initial[:, own]
    if gravity is not None:
        fall[:3] = gravity.acceleration * np.array(gravity.direction)
    sinks = np.tile(fall[own], count)
    if gravity is None or not sinks.any() or not (gravity.static or any(scene.bears)):
        return 0 * sinks, initial.ravel(), sinks
    B, masses = system.relative(held, *mass.shape)[:, : c * count], mass[:count].ravel()
    D = system.resistance(held, held.springs, c)
    rest = spsolve((B.T @ D @ B).tocsc(), masses * sinks)
    borne = -(D @ (B @ rest)).reshape(-1, c)
    if gravity.static:
        sinks = 0 * sinks
    else:
        borne[1:-1] = 0.0
        borne[[0, -1]] *= np.array(scene.bears)[:, None]
        rest, sinks = 0 * rest, sinks + B.T @ borne.ravel() / masses
    initial[: count + 1] += borne
    return rest, initial.ravel(), sinks
