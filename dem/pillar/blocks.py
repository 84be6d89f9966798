"""The rigid blocks of a pillar: of length alone where all motion is along it, else in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwave.cases.effects import is_spatial
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.material.strength import strength_of
from jointwave.cases.run_memory import refuse_beyond_memory
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.scene import Scene
from jointwave.dem.build import RigidBlocks
from jointwave.dem.columns import Columns
from jointwave.dem.contacts import Contacts
from jointwave.joints.law import law, stiffest

ENDS = "start", "end"
CUT = 400  # bytes of a block while a pillar is cut


@dataclass(frozen=True, kw_only=True)
class BlocksOfPillar(RigidBlocks):
    """A pillar as rigid blocks, one after the other; y runs along it, its axis is x = z = 0.

    properties : their numbers. The last contacts join the first and the last block to walls, where
    these ends are fixed.
    """

    scene: Scene
    properties: Properties

    @property
    def size(self) -> np.ndarray:
        """The thickness of each block [N], m."""
        return np.diff(self.properties.contact_y)

    @property
    def along(self) -> int:
        """Which axis is y."""
        return self.dim // 2


def blocks_of(scene: Scene) -> BlocksOfPillar:
    """Return the rigid blocks of a pillar; raises SceneError for more than memory holds."""
    refuse_beyond_memory(scene, {"pillar.block": CUT * scene.block_count})
    p, dim = calibrate(scene), 3 if is_spatial(scene) else 1
    axes, turns = ([0, 1, 2] if dim == 3 else [1]), dim == 3 and scene.motion.rotation != "none"
    gravity, stress = np.zeros(3), None
    if scene.gravity is not None:
        gravity = scene.gravity.acceleration * np.array(scene.gravity.direction)
    if scene.prestress is not None:
        stress = np.zeros((dim, dim))
        stress[dim // 2, dim // 2] = scene.prestress.normal
    centroid = np.zeros((p.block_count, dim))
    centroid[:, dim // 2] = p.centre_y
    contacts = contacts_of(scene, p, dim)
    return BlocksOfPillar(
        scene=scene,
        centroid=centroid,
        contacts=contacts,
        columns=columns_of(scene, p, contacts, turns),
        masses=masses_of(p, dim, turns),
        gravity=gravity[axes],
        prestress=stress,
        finite=turns and scene.motion.rotation == "finite",
        properties=p,
    )


def masses_of(p: Properties, dim: int, turns: bool) -> np.ndarray:
    """Return the matrices of mass and inertia of the blocks [N, F, F]."""
    mass = np.full(p.block_count, p.block_mass) if p.masses is None else p.masses
    if dim == 1:
        return mass[:, None, None]
    parts = [mass] * 3
    if turns:
        whole = p.inertia_across, p.inertia_along, p.inertia_across
        parts += [mass * (one / p.block_mass) for one in whole]
    return np.stack(parts, axis=1)[:, :, None] * np.eye(len(parts))


def contacts_of(scene: Scene, p: Properties, dim: int) -> Contacts:
    """Return the contacts of a pillar: between its blocks, then with the walls of fixed ends.

    The frame of those between blocks is y, z, x, so that the normal points along the pillar.
    """
    kinds, count = (scene.ends.start, scene.ends.end), p.block_count
    walls = tuple(name for name, kind in zip(ENDS, kinds, strict=True) if kind == "fixed")
    first, last = (0 if one == "start" else count - 1 for one in ENDS)
    held = np.array([first if one == "start" else last for one in walls], dtype=int)
    outwards = np.array([-1.0 if one == "start" else 1.0 for one in walls])
    k, half = np.arange(count - 1), np.diff(p.contact_y) / 2
    i = np.concatenate([k, held])
    sign = np.concatenate([np.ones(count - 1), outwards])
    normal, arm = np.zeros((len(i), dim)), np.zeros((len(i), 2, dim))
    normal[:, dim // 2] = sign
    arm[:, 0, dim // 2] = sign * half[i]
    arm[: count - 1, 1, dim // 2] = -half[1:]
    frame = normal[:, None]
    if dim == 3:
        frame = np.zeros((len(i), 3, 3))
        frame[:, 0, 1], frame[:, 1, 2], frame[:, 2, 0] = sign, sign, 1.0
    centre = np.zeros((len(i), dim))
    centre[:, dim // 2] = p.contact_y[np.where(sign > 0, i + 1, 0)]
    return Contacts(
        blocks=np.stack([i, np.concatenate([k + 1, count + np.arange(len(walls))])], axis=1),
        area=np.full(len(i), p.area),
        centre=centre,
        frame=frame,
        arm=arm,
        spread=np.tile(p.area / 12 * np.eye(dim - 1), (len(i), 1, 1)),
        column=np.arange(len(i)),
        walls=walls,
    )


def columns_of(scene: Scene, p: Properties, contacts: Contacts, turns: bool) -> Columns:
    """Return the law of the contacts, each in a column of its own where they differ."""
    dim, count = contacts.frame.shape[1], p.block_count
    walls = [p.at_start if one == "start" else p.at_end for one in contacts.walls]
    rest = np.zeros(len(walls))
    normal = np.append(p.stiffness, [one.wall_stiffness for one in walls])
    shear = np.append(p.shear_stiffness, [one.wall_shear_stiffness for one in walls])
    eta, rock = p.joint_time_constant, p.rock_compliance
    eta = None if eta is None else np.append(eta, rest)
    which = np.full(count - 1 + len(walls), 1 + len(scene.layers))  # of no joint
    which[: count - 1][~p.weld], which[p.soft] = 0, 1 + np.arange(len(p.soft))
    laws = [scene.joints, *scene.layers, JointLaw()]
    strengths = strength_of(laws[: which.max() + 1], which).strengths(shears=dim > 1)
    found = law(
        normal,
        eta,
        np.append(p.tension, rest == 0),
        shear_stiffness=shear if dim > 1 else None,
        rock_compliance=None if rock is None else np.append(rock, rest),
        **strengths,
    )
    most = [np.resize(0.0 if one is None else one, len(normal)) for one in stiffest(found, scene)]
    rule = scene.joints.point_rule, scene.joints.contact_points
    return Columns(
        law=found,
        normal=normal,
        shear=shear * (dim > 1),
        stiffest=np.array(most),
        time_constants=None if eta is None else np.stack([eta, eta]),
        rules=[rule if turns else ("midpoint", 1)],
        fails=not p.tension.all() or bool(strengths),
    )
