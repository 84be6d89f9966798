"""Loads, dashpots and springs at the ends of a pillar.

A quiet end has dashpots Z of the rock beyond, spread over the end face. A matched end has the same
dashpots behind half of a joint's springs (`joints.ends`). A fixed end is a wall, a contact of
`blocks.pillar`; the dashpots of the half block before it are here, since they act on the mean
velocity of both half steps, as all boundary dashpots do.
"""

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.measure import along_and_across, frames_of
from jointwave.cases.loads import late_load
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.partition.pillar import SIDES
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.tables import LEAN
from jointwave.dem.contacts.faces import jumps_of, springs_of
from jointwave.dem.sides.boundaries import facets_on, points_on
from jointwave.dem.sides.loads import Pattern, reactions
from jointwave.dem.sides.shaking import Base
from jointwave.dem.sides.surroundings import EndSpring, Surroundings
from jointwave.joints.ends import half_spring
from jointwave.joints.law import Law, parts_of
from jointwave.joints.normal import gap_under


def surroundings_of(
    scene: Scene, cut: Blocks, share: float, rotations: int, stress: np.ndarray | None
) -> Surroundings:
    """Return the surroundings of a pillar.

    share : second moments of contact points over those of the face. rotations : of a block.
    stress : the prestress [d, d], Pa.
    """
    p, dim, shaken = calibrate(scene), cut.body.dim, scene.shakes_base
    rocks, kinds = (p.at_start, p.at_end), (scene.ends.start, scene.ends.end)
    points = points_on(cut, facets_on(cut, SIDES, SIDES[:2]), share=share)
    end = (points.normal[:, dim // 2] > 0).astype(int)
    impedance = np.array([_dashpots(*one) for one in zip(kinds, rocks, strict=True)])
    walls = np.array([(one.wall_stiffness, one.wall_shear_stiffness) for one in rocks])
    patterns = [] if shaken else [_push(scene, cut)]
    if stress is not None:
        bear = facets_on(cut, SIDES, scene.ends.sides("free", "quiet", "matched"))
        patterns.append(reactions(cut, bear, stress))
    direction = np.array(scene.load.direction)[[1] if dim == 1 else slice(None)]
    return Surroundings(
        points=points,
        impedance=along_and_across(points.normal, impedance[end]),
        borne=along_and_across(points.normal, (walls * np.transpose([scene.bears]))[end]),
        patterns=patterns,
        bases=[Base("start", scene.load, direction)] * shaken,
        springs=tuple(
            _spring(cut, name, rock.at_rest, share, rotations)
            for name, kind, rock in zip(SIDES, kinds, rocks, strict=False)
            if kind == "matched"
        ),
    )


def _dashpots(kind: str, rock: JointedRock) -> list[float]:
    """Return the axial and transverse impedance of an end's dashpots, Pa s/m."""
    eta = rock.time_constant or 0.0
    if kind == "fixed":
        return [eta * rock.wall_stiffness, eta * rock.wall_shear_stiffness]
    if kind == "free":
        return [0.0, 0.0]
    rock = rock.at_rest
    beyond = [rock.impedance, rock.shear_impedance]
    if kind == "quiet":
        return beyond
    halves = 2 * rock.regular_stiffness, 2 * rock.regular_shear_stiffness
    return [half_spring(k, eta, z).viscosity for k, z in zip(halves, beyond, strict=True)]


def _spring(cut: Blocks, name: str, rock: JointedRock, share: float, rotations: int) -> EndSpring:
    """Return the half of a joint's springs before the dashpots of a matched end."""
    face, edges = facets_on(cut, SIDES, [name])[:1], cut.boundary
    block, area, frame = edges.blocks[face, 0], edges.area[face], frames_of(edges.normal[face])
    second = share * edges.second_moment[face] / area[:, None, None]
    spread = frame[:, 1:] @ second @ frame[:, 1:].swapaxes(1, 2)

    def over_face(normal: float, shear: float) -> np.ndarray:
        pair = np.full(1, normal), np.full(1, shear)
        return np.diag(springs_of(*pair, area, spread, rotations)[0])

    return EndSpring(
        int(block[0]),
        jumps_of(frame, edges.centroid[face] - cut.centroid[block], rotations)[0],
        over_face(2 * rock.regular_stiffness, 2 * rock.regular_shear_stiffness),
        over_face(rock.impedance, rock.shear_impedance),
        rock.time_constant or 0.0,
    )


def _push(scene: Scene, cut: Blocks) -> Pattern:
    """Return the load on the start face as forces."""
    load, dim, face = scene.load, cut.body.dim, facets_on(cut, SIDES, SIDES[:1])[0]
    history, direction, area = late_load(scene), np.array(load.direction), scene.pillar.area
    arm = cut.boundary.centroid[face] - cut.centroid[0]
    if load.arm is not None:  # a couple
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


def under_weight(scene: Scene, p: Properties, weight: np.ndarray) -> np.ndarray | None:
    """Return the axial displacement [N], m, of blocks between elastic joints under their weights
    [N], N; None without weight or a held end.

    The axial forces follow from equilibrium, and with two held ends from the springs.
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
