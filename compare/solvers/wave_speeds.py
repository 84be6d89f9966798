"""Wave speeds in each engine's model of a rock mass."""

import numpy as np

from jointwave.cases.material.effective_medium import speeds as speeds_of_medium
from jointwave.cases.material.effective_medium import stiffness
from jointwave.cases.material.rigid_blocks import long_wave_stiffness
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.material.rock_mass import sets_at_rest
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.solvers.record import Rock

RIGID = 1e3  #: ratio to the speed in intact rock above which nothing deforms

#: Speeds of P and S waves, m/s, by medium and axis; infinite where nothing deforms.
Speeds = dict[str, tuple[float, float]]


def speeds(scene: RockMass, resolved: Rock) -> Speeds:
    """Return wave speeds outside all regions of rock, as an engine resolves it, between joints that
    the initial stress has closed. Long waves are long compared with the blocks."""
    sets = sets_at_rest(scene)
    if resolved is Rock.RIGID_BLOCKS:
        return _along_axes(long_wave_stiffness(scene, further_sets(scene), sets), scene)
    rock = elastic_rock(scene.rock)
    dim = scene.domain.dimension
    found = _along_axes(stiffness(rock, sets, dim), scene) if sets else {}
    if resolved is Rock.JOINTED or not sets:
        found["intact rock"] = float(rock.p_speed), float(rock.s_speed)
    return found


def _along_axes(medium: np.ndarray, scene: RockMass) -> Speeds:
    """Return the speeds of a medium's long waves along the axes: P has the polarisation nearest to
    the axis, S is the slowest of the others."""
    dim = scene.domain.dimension
    found, shapes = speeds_of_medium(medium, scene.rock.density, np.eye(dim))
    found[found > RIGID * float(elastic_rock(scene.rock).p_speed)] = np.inf
    p = np.abs(np.diagonal(shapes, axis1=0, axis2=1)).argmax(axis=0)
    return {
        f"long waves along {axis}": (float(found[i, p[i]]), float(np.delete(found[i], p[i]).min()))
        for i, axis in enumerate("xyz"[:dim])
    }
