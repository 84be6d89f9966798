"""The ends of a pillar, as what they do to the first and the last block.

A quiet end is the dashpots Z of the rock beyond, spread over the end face. A matched end has the
same dashpots behind the half of a joint's springs that the end face leaves, `joints.ends`. A fixed
end is a wall, `dem.pillar`; the dashpots of the half block before it are here, for they see the
mean velocity of both half steps like all that are beyond the pillar.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.dem.contacts import jumps_of, springs_of
from jointwave.dem.pillar.blocks import BlocksOfPillar
from jointwave.joints.ends import half_spring


class End(NamedTuple):
    """What one end does to its block, matrices [F, F] of the block's freedoms.

    kind : of the end. block : its number. lever : makes the block's motion that of the end face.
    dashpot : N s/m. springs : as in `model.Held` [3, F, F]; None without. stiffness : at the
    critical step, N/m.
    """

    kind: str
    block: int
    lever: np.ndarray
    dashpot: np.ndarray
    springs: np.ndarray | None
    stiffness: np.ndarray


def ends_of(blocks: BlocksOfPillar, dt: float = 0.0) -> list[End]:
    """Return the start and the end of a pillar, in steps of dt, s."""
    scene, p = blocks.scene, blocks.properties
    rocks = ((scene.ends.start, p.at_start, 0), (scene.ends.end, p.at_end, blocks.count - 1))
    return [_end(blocks, kind, rock, block, dt) for kind, rock, block in rocks]


def _end(blocks: BlocksOfPillar, kind: str, rock: JointedRock, block: int, dt: float) -> End:
    """Return the end of this kind at a block."""
    contacts, size, eta = blocks.contacts, blocks.masses.shape[1], rock.time_constant or 0.0
    lever = jumps_of(contacts.frame[:1], arm_of(blocks, block)[None], size - blocks.dim)[0]
    nothing = End(kind, block, lever, np.zeros((size, size)), None, np.zeros((size, size)))

    def spread(*pair: float) -> np.ndarray:
        return over_face(blocks, *pair)

    def onto(values: np.ndarray) -> np.ndarray:
        return lever.T * values @ lever

    dashpots = spread(rock.impedance, rock.shear_impedance)
    if kind == "quiet":
        return nothing._replace(dashpot=onto(dashpots))
    if kind == "fixed":
        walls = spread(rock.wall_stiffness, rock.wall_shear_stiffness)
        return nothing._replace(dashpot=onto(eta * walls))
    if kind == "free":
        return nothing
    halves = spread(2 * rock.regular_stiffness, 2 * rock.regular_shear_stiffness)
    found = [half_spring(k, eta, z, dt) for k, z in zip(halves, dashpots, strict=True)]
    stiffness, viscosity, decay, gain, critical = np.array(found).T
    springs = np.stack([np.diag(decay), gain[:, None] * lever, lever.T * stiffness])
    return End(kind, block, lever, onto(viscosity), springs, onto(critical))


def over_face(blocks: BlocksOfPillar, normal: float, shear: float) -> np.ndarray:
    """Return what springs or dashpots per area, spread over a face like the points of joints, do
    against its motion [F]."""
    contacts, dim = blocks.contacts, blocks.dim
    spread = blocks.columns.bending[0] * contacts.spread[:1]
    pair = np.full(1, normal), np.full(1, shear)
    return np.diag(springs_of(*pair, contacts.area[:1], spread, blocks.masses.shape[1] - dim)[0])


def arm_of(blocks: BlocksOfPillar, block: int) -> np.ndarray:
    """Return the arm from the centroid of the first or the last block to its end face [d], m."""
    half, arm = np.diff(blocks.properties.contact_y) / 2, np.zeros(blocks.dim)
    arm[blocks.along] = -half[0] if block == 0 else half[-1]
    return arm
