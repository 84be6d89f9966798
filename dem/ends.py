"""The ends of a pillar, as what acts on its first and its last block.

A quiet end is the dashpots Z of the rock beyond, spread over the end face. A matched end has the
same dashpots behind the half of a joint's springs that the end face leaves, `joints.ends`. A fixed
end is a wall, a contact of `dem.pillar`; the dashpots of the half block before it are here, for
they see the mean velocity of both half steps like all that are beyond the pillar.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.material.quiet_sides import along_and_across
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.tables import LEAN
from jointwave.dem.boundaries import BoundaryPoints
from jointwave.dem.contacts import jumps_of, springs_of
from jointwave.dem.loads import Pattern
from jointwave.dem.shaking import Base
from jointwave.dem.surroundings import EndSpring, Surroundings
from jointwave.joints.ends import half_spring
from jointwave.joints.law import Law, parts_of
from jointwave.joints.normal import gap_under


class End(NamedTuple):
    """An end face: its kind, its block, the arm from that one's centroid to it [d], m, and the rock
    there."""

    kind: str
    block: int
    arm: np.ndarray
    rock: JointedRock


class Face(NamedTuple):
    """The faces of a pillar: area, m2, second moments of their points over it [d - 1, d - 1], m2,
    and the rotations of blocks."""

    area: float
    spread: np.ndarray
    rotations: int


def ends_of(scene: Scene, p: Properties, dim: int) -> list[End]:
    """Return the start and the end of a pillar."""
    half, arms = np.diff(p.contact_y) / 2, np.zeros((2, dim))
    arms[:, dim // 2] = -half[0], half[-1]
    kinds, blocks = (scene.ends.start, scene.ends.end), (0, p.block_count - 1)
    return [End(*one) for one in zip(kinds, blocks, arms, (p.at_start, p.at_end), strict=True)]


def surroundings_of(
    scene: Scene, p: Properties, centroid: np.ndarray, face: Face, stress: np.ndarray | None
) -> Surroundings:
    """Return what acts on a pillar of blocks at these centroids [N, d]; stress : its prestress
    [d, d], Pa."""
    dim = centroid.shape[1]
    ends, shaken = ends_of(scene, p, dim), scene.shakes_base
    parts = [_points_on(one, centroid, face) for one in ends]
    each, along = 2 ** (dim - 1), [0, 1, 2] if dim == 3 else [1]
    bears = np.repeat(np.array(scene.bears, dtype=float), each)
    points = BoundaryPoints(*map(np.concatenate, zip(*parts, strict=True)))
    dashpots = np.repeat([_dashpots(one) for one in ends], each, axis=0)
    return Surroundings(
        points=points,
        impedance=along_and_across(points.normal, dashpots),
        borne=bears[:, None, None] * np.eye(dim),
        moves=np.repeat([shaken, False], each),
        patterns=[*([] if shaken else [_push(scene, p, ends[0])]), *_reactions(ends, p, stress)],
        bases=[Base("start", scene.load, np.array(scene.load.direction)[along])] * shaken,
        springs=tuple(_spring(one, face) for one in ends if one.kind == "matched"),
    )


def _dashpots(end: End) -> list[float]:
    """Return the impedances of the dashpots on a block's end, along it and across, Pa s/m."""
    rock, eta = end.rock, end.rock.time_constant or 0.0
    beyond = [rock.impedance, rock.shear_impedance]
    if end.kind == "quiet":
        return beyond
    if end.kind == "fixed":
        return [eta * rock.wall_stiffness, eta * rock.wall_shear_stiffness]
    if end.kind == "free":
        return [0.0, 0.0]
    halves = 2 * rock.regular_stiffness, 2 * rock.regular_shear_stiffness
    return [half_spring(k, eta, z).viscosity for k, z in zip(halves, beyond, strict=True)]


def _points_on(end: End, centroid: np.ndarray, face: Face) -> BoundaryPoints:
    """Return points on an end face with its area and the second moments of the points of joints."""
    dim = len(end.arm)
    signs = np.array(list(product((-1.0, 1.0), repeat=dim - 1)))
    arm = np.repeat(end.arm[None], len(signs), axis=0)
    normal = np.sign(arm)
    arm[:, [0, 2][: dim - 1]] = signs @ np.sqrt(face.spread)
    block = np.full(len(arm), end.block)
    return BoundaryPoints(
        block, centroid[block] + arm, arm, normal, np.full(len(arm), face.area / len(arm))
    )


def _spring(end: End, face: Face) -> EndSpring:
    """Return the half of a joint's springs before the dashpots of a matched end."""
    dim, rock = len(end.arm), end.rock
    frame = np.eye(dim)[[1, 2, 0]] if dim == 3 else np.eye(1)

    def over_face(normal: float, shear: float) -> np.ndarray:
        pair = np.full(1, normal), np.full(1, shear), np.full(1, face.area)
        return np.diag(springs_of(*pair, face.spread[None], face.rotations)[0])

    return EndSpring(
        end.block,
        jumps_of(frame[None], end.arm[None], face.rotations)[0],
        over_face(2 * rock.regular_stiffness, 2 * rock.regular_shear_stiffness),
        over_face(rock.impedance, rock.shear_impedance),
        rock.time_constant or 0.0,
    )


def _push(scene: Scene, p: Properties, start: End) -> Pattern:
    """Return the load on the start face as forces."""
    load, dim, area = scene.load, len(start.arm), p.area
    history, arm, direction = load_history(scene), start.arm.copy(), np.array(load.direction)
    if load.arm is not None:  # a pair of forces
        across = np.eye(3)[2 if abs(direction[2]) < LEAN else 0]
        across = across - (across @ direction) * direction
        across /= np.linalg.norm(across)
        force = area * load.arm * np.cross(direction, across) / 2
        pair = np.array([[1.0], [-1.0]])
        return Pattern(np.zeros(2, int), pair * across, pair * force, history)
    if dim == 1:
        return Pattern(np.zeros(1, int), arm[None], area * direction[None, 1:2], history)
    arm[0], arm[2] = load.at
    return Pattern(np.zeros(1, int), arm[None], area * direction[None], history)


def _reactions(ends: list[End], p: Properties, stress: np.ndarray | None) -> list[Pattern]:
    """Return what bears a prestress on ends that are not fixed."""
    if stress is None:
        return []
    free = [one for one in ends if one.kind != "fixed"]
    forces = [-p.area * np.sign(one.arm) @ stress for one in free]
    return [
        Pattern(np.array([one.block]), one.arm[None], force[None], None)
        for one, force in zip(free, forces, strict=True)
    ]


def under_weight(scene: Scene, p: Properties, weight: np.ndarray) -> np.ndarray | None:
    """Return the displacement [N] along a pillar of blocks between elastic joints under the weight
    of each [N], N, which the ends bear that are held; None where none is.

    The forces are those of equilibrium, between two held ends as the springs share them.
    """
    kinds = scene.ends.start, scene.ends.end
    held = [kind == "fixed" or bears for kind, bears in zip(kinds, scene.bears, strict=True)]
    if not weight.any() or not any(held):
        return None
    walls = p.area * p.at_start.wall_stiffness, p.area * p.at_end.wall_stiffness
    force = np.append(0.0, np.cumsum(weight))
    if all(held):
        soft = 1 / np.concatenate([walls[:1], p.stiffness * p.area, walls[1:]])
        force -= (soft @ force) / soft.sum()
    elif held[0]:
        force -= force[-1]
    before = scene.prestress.normal if scene.prestress else 0.0
    law = Law(p.stiffness, rock_compliance=p.rock_compliance, **p.strengths(shears=False))
    after, rest = (
        gap_under(law, parts_of(law), one) for one in (before + force[1:-1] / p.area, before)
    )
    moved = np.append(0.0, np.cumsum(after - rest))
    return moved + (-force[0] / walls[0] if held[0] else force[-1] / walls[1] - moved[-1])
