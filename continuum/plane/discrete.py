"""A rock mass in space, and sums over its blocks and contacts."""

from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.periodic import Across, of_all
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.model import Interfaces
from jointwave.continuum.space.body import Body
from jointwave.continuum.space.elasticity import PlaneRock, Section
from jointwave.continuum.space.interface import Jumps
from jointwave.continuum.space.kinematics import Kinematics

MOTION = Kinematics(2, Section(2, 1.0), False)


class PlaneDiscrete(NamedTuple):
    """A rock mass in space.

    resolved : the scene with the joint sets that are resolved alone. partition : of it.
    across : contacts across periodic sides. block : int array [cells]; vertex : int array [cells,
    corners], `PlaneMesh`. materials : [rock] and the regions'. jumps, joints : None without any.
    """

    resolved: RockMass
    partition: Partition
    across: list[Across]
    block: np.ndarray
    vertex: np.ndarray
    materials: list[PlaneRock]
    body: Body
    jumps: Jumps | None
    joints: Interfaces | None
    kinematics: Kinematics = MOTION


def blocks_of(found: PlaneDiscrete) -> np.ndarray:
    """Return the two blocks of every contact, those across periodic sides last [c, 2]."""
    return of_all(found.partition.blocks, found.across, "blocks")


def motion_of_blocks(found: PlaneDiscrete, u: np.ndarray) -> np.ndarray:
    """Return the mean displacement (m) and rotation of each block [n, 3], of its nodes' motion."""
    body, partition = found.body, found.partition
    own = np.flatnonzero(body.cells[:, 0] >= 0)
    node, block = body.cells[own], np.repeat(found.block[own], body.cells.shape[1])
    moved = u[body.freedom(node[:, :, None], np.arange(2))].reshape(-1, 2)
    arm = body.x[node].reshape(-1, 2) - partition.centroid[block]
    (a, b), (x, y) = arm.T, moved.T
    values = np.ones_like(a), x, y, a, b, a * y - b * x, a * a + b * b
    sums = np.array([np.bincount(block, one, minlength=partition.count) for one in values])
    whole: Any = body.communicator.sum(sums)  # type: ignore[arg-type]
    count, x, y, a, b, turned, spread = whole
    x, y, a, b = x / count, y / count, a / count, b / count
    turn = (turned - count * (a * y - b * x)) / (spread - count * (a * a + b * b))
    return np.stack([x + turn * b, y - turn * a, turn], axis=1)


def stress_of(scene: RockMass) -> np.ndarray:
    """Return the prestress, xx, yy, xy [3], Pa, compression positive; zero without."""
    given = scene.prestress
    return np.zeros(3) if given is None else np.array([given.xx, given.yy, given.xy])


def prestressed(scene: RockMass, discrete: PlaneDiscrete, pushing: float, relaxed: float) -> float:
    """Return the root of twice the energy (sqrt(J/m)) that a prestress keeps in rock and joints,
    and that rock gives off by pushing on both sides of joints that open, so long (s/sqrt(kg)).

    relaxed : what the rock keeps of its stiffness in the end.
    """
    stress, joints, shared = stress_of(scene), discrete.joints, discrete.body.communicator
    softest = min(np.linalg.eigvalsh(one.stiffness).min() for one in discrete.materials)
    least = relaxed * softest
    stored = float(stress @ stress) / least * float(discrete.partition.area.sum())
    size, softness = float(np.abs(stress).max()), 0.0
    if joints is not None:
        law = joints.law
        softness = max(np.max(1 / law.normal_stiffness), np.max(1 / law.shear_stiffness))
    length = shared.sum(0.0 if joints is None else float(joints.area.sum()))
    stored += 4 * size**2 * length * shared.largest(softness)
    return float(np.sqrt(stored)) + pushing * 4 * size * length
