"""The speeds of the waves in each engine's model of a scene."""

from itertools import pairwise
from math import isfinite, sqrt

import numpy as np

from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.material.effective_medium import compliant, stiffness
from jointwave.cases.material.effective_medium import speeds as speeds_of_medium
from jointwave.cases.material.elastic import shear_modulus
from jointwave.cases.material.rigid_blocks import long_wave_stiffness
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.regions import within
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.segment import alone, regions
from jointwave.compare.solvers.record import Rock

RIGID = 1e3  #: times the speed of intact rock: no strain at all

#: Speeds along the pillar, or of P waves, and across it, or of S waves, m/s, by what has them;
#: infinite where nothing deforms.
Speeds = dict[str, tuple[float, float]]


def speeds(scene: AnyScene, rock: Rock) -> Speeds:
    """Return the speeds of waves in a scene as an engine resolves its rock; of rock masses in the
    rock of no region.

    Long waves are those of wavelengths that are large against the blocks and a pillar's side.
    """
    return _of_pillar(scene, rock) if isinstance(scene, Scene) else _of_rock_mass(scene, rock)


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
    rock = elastic_rock(scene.rock)
    sets = compliant(within(scene, scene.joint_sets)[-1].joint_sets)
    if resolved is Rock.RIGID_BLOCKS:
        return _along_axes(long_wave_stiffness(scene, further_sets(scene)), scene)
    found = _along_axes(stiffness(rock, sets), scene) if sets else {}
    if resolved is Rock.JOINTED or not sets:
        found["intact rock"] = float(rock.p_speed), float(rock.s_speed)
    return found


def _along_axes(medium: np.ndarray, scene: RockMass) -> Speeds:
    """Return the speeds of a medium's long waves along x and y, that of P first: of the two shapes
    that which moves more along the axis."""
    found, shapes = speeds_of_medium(medium, scene.rock.density, np.eye(2))
    found[found > RIGID * float(elastic_rock(scene.rock).p_speed)] = np.inf
    p = np.abs(np.diagonal(shapes, axis1=0, axis2=1)).argmax(axis=0)
    return {
        f"long waves along {axis}": (float(found[i, p[i]]), float(found[i, 1 - p[i]]))
        for i, axis in enumerate("xy")
    }
