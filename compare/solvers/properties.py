"""What each engine's model of a scene has: the speeds of its waves and the levers of its contact
points."""

from collections.abc import Sequence
from itertools import pairwise
from math import isfinite, sqrt
from typing import Any

import numpy as np

from jointwave.cases.effects import bends
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.material.contact_points import lever
from jointwave.cases.material.effective_medium import compliant, stiffness
from jointwave.cases.material.effective_medium import speeds as speeds_of_medium
from jointwave.cases.material.elastic import shear_modulus
from jointwave.cases.material.rigid_blocks import long_wave_stiffness
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.regions import within
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint import Joints
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.segment import alone, regions
from jointwave.compare.solvers.record import Rock

RIGID = 1e3  #: times the speed of intact rock: no strain at all
AXES = {"x": [1.0, 0.0], "y": [0.0, 1.0]}

#: Speeds along the pillar, or of P waves, and across it, or of S waves, m/s, by what has them;
#: infinite where nothing deforms.
Speeds = dict[str, tuple[float, float]]


def speeds(scene: AnyScene, rock: Rock) -> Speeds:
    """Return the speeds of waves in a scene as an engine resolves its rock; of rock masses in the
    rock of no region.

    Long waves are those of wavelengths that are large against the blocks and a pillar's side.
    """
    return _of_pillar(scene, rock) if isinstance(scene, Scene) else _of_rock_mass(scene, rock)


def least_lever(scene: AnyScene, rock: Rock) -> float | None:
    """Return how far the outermost points of a joint are from the centre of its face, over the half
    width; of rock masses that of the joint set with the least. None where nothing bends, and for a
    pillar's mesh from a file."""
    if isinstance(scene, Scene) and not bends(scene):
        return None
    if rock is Rock.JOINTED:
        return _of_elements(scene)
    rules: Sequence[Joints] = [scene.joints] if isinstance(scene, Scene) else scene.joint_sets
    levers = [lever(one.point_rule, one.contact_points) for one in rules]
    return min(levers, default=None) if rock is Rock.RIGID_BLOCKS else None


def _of_elements(scene: AnyScene) -> float | None:
    from jointwave.continuum.mesh.cells import KINDS
    from jointwave.continuum.space import interface
    from jointwave.continuum.space.kinematics import kinematics

    numerics: Any = scene.numerics.continuum
    if not isinstance(scene, Scene):
        return interface.lever("triangle", numerics.order)
    if numerics.mesh is not None:
        return None
    kind = KINDS[kinematics(scene).dim, numerics.cell]
    return interface.lever(kind, numerics.order, numerics.elements_across)


def _of_pillar(scene: Scene, rock: Rock) -> Speeds:
    """Return the speeds of each segment, and those between joints that stand apart from rock."""
    p, found = calibrate(scene), {}
    for one, region, (start, stop) in zip(p.each, regions(scene), spans(p), strict=True):
        where = f"{start:g} to {stop:g} m, " if len(p.each) > 1 else ""
        found[f"{where}long waves"] = one.bar_speed, one.shear_speed
        if rock is Rock.JOINTED and isfinite(one.regular_own_stiffness):
            modulus, poisson = one.intact_modulus, alone(scene, region).rock.intact_poisson
            assert modulus is not None
            shear = shear_modulus(modulus, poisson)
            found[f"{where}between joints"] = sqrt(modulus / one.density), sqrt(shear / one.density)
    return found


def spans(p: Properties) -> list[tuple[float, float]]:
    """Return where each segment of a pillar begins and ends, m."""
    ends = p.contact_y[np.cumsum([0, *(one.block_count for one in p.each)])].tolist()
    return list(pairwise(ends))


def _of_rock_mass(scene: RockMass, resolved: Rock) -> Speeds:
    if resolved is Rock.RIGID_BLOCKS:
        return _along_axes(long_wave_stiffness(scene, further_sets(scene)), scene)
    rock = elastic_rock(scene.rock)
    sets = compliant(within(scene, scene.joint_sets)[-1].joint_sets)
    found = _along_axes(stiffness(rock, sets), scene) if sets else {}
    if resolved is Rock.JOINTED or not sets:
        found["intact rock"] = float(rock.p_speed), float(rock.s_speed)
    return found


def _along_axes(medium: np.ndarray, scene: RockMass) -> Speeds:
    """Return the speeds of a medium's long waves along x and y."""
    found, shapes = speeds_of_medium(medium, scene.rock.density, np.array(list(AXES.values())))
    found[found > RIGID * float(elastic_rock(scene.rock).p_speed)] = np.inf
    pairs = {}
    for name, direction, both, shape in zip(AXES, AXES.values(), found, shapes, strict=True):
        p = int(np.abs(np.array(direction) @ shape).argmax())
        pairs[f"long waves along {name}"] = float(both[p]), float(both[1 - p])
    return pairs
