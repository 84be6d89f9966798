"""A rock mass in space: its blocks as elements, and the joints between them.

Plane strain; all is per metre of thickness. "jointed" resolves every joint. "equivalent" has the
effective medium of the sets with a spacing, and joints that stand alone as they are.
"""

from __future__ import annotations

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.material.effective_medium import compliant, stiffness
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.material.rock_mass import set_time_constants
from jointwave.cases.material.strength import strength_of
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.periodic import Across, across_periodic, of_all
from jointwave.cases.partition.regions import within
from jointwave.cases.partition.scene import partition_of
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.joints import interfaces
from jointwave.continuum.mesh.plane import plane_mesh
from jointwave.continuum.plane.discrete import MOTION, PlaneDiscrete, stress_of
from jointwave.continuum.plane.size import element_sizes, refuse_large_mesh
from jointwave.continuum.space.assembly import body_and_jumps
from jointwave.continuum.space.elasticity import PlaneRock
from jointwave.joints.law import Law, law


def smeared(scene: RockMass, model: str) -> list[JointSet]:
    """Return the joint sets that a model does not resolve."""
    return [one for one in scene.joint_sets if model == "equivalent" and one.spacing is not None]


def discretise(scene: RockMass, model: str, comm=None) -> PlaneDiscrete:
    """Return a rock mass in space; `model` is "jointed" or "equivalent".

    comm : mpi4py's communicator of the processes that share it; None for a single process.
    Raises SceneError where the scene cannot be cut or meshed as it asks for.
    """
    sets = smeared(scene, model)
    kept = [one for one in scene.joint_sets if one not in sets]
    resolved = scene.model_copy(update={"joint_sets": kept})
    partition = partition_of(resolved)
    across = across_periodic(scene, partition.blocks)
    relaxes = mechanisms_of(scene, model)
    unrelaxed = 1.0 if relaxes is None else relaxes.unrelaxed
    *regions, rest = (
        PlaneRock(
            unrelaxed * stiffness(elastic_rock(one.rock), compliant(one.joint_sets)),
            one.rock.density,
            _rayleigh(scene),
        )
        for one in within(scene, sets)
    )
    rocks = [rest, *regions]
    meshed = _mesh(scene, partition, across)
    order = scene.numerics.continuum.order
    body, between = body_and_jumps(comm, meshed.mesh, order, rocks, MOTION.section, paired=True)
    body = body._replace(piece=meshed.piece)
    places = meshed.block, meshed.vertex
    found = PlaneDiscrete(resolved, partition, across, *places, rocks, body, None, None)
    if between is None:
        return found
    own = contact_law(resolved, found, between.joint)
    carried = _carried(scene, found, between.joint)
    return found._replace(jumps=between, joints=interfaces(between, own, carried, scene))


def _mesh(scene: RockMass, partition: Partition, across: list[Across]):
    numerics, sizes = scene.numerics.continuum, element_sizes(scene)
    refuse_large_mesh(scene, partition, max(sizes.values()))
    try:
        found = plane_mesh(partition, across, sizes, numerics.cell)
    except ValueError as error:
        key = "numerics.continuum.cell"
        raise SceneError(scene.where, key, numerics.cell, str(error)) from None
    except ImportError as error:
        key, allowed = "numerics.continuum.cell", f"needs gmsh for triangles ({error})"
        raise SceneError(scene.where, key, numerics.cell, allowed) from None
    if found.mesh.cell == "triangle" and numerics.order > 2:
        key, allowed = "numerics.continuum.order", "must be at most 2 for triangles"
        why = "" if numerics.cell else ": not every block has four edges with one neighbour each"
        raise SceneError(scene.where, key, numerics.order, allowed + why)
    return found


def _rayleigh(scene: RockMass) -> float:
    """Return the time constant of the rock itself, s."""
    return 0.0 if scene.damping.rayleigh is None else scene.damping.rayleigh.coefficients[1]


def contact_law(scene: RockMass, found: PlaneDiscrete, contact: np.ndarray) -> Law:
    """Return the law at points [q] of these contacts, in its smallest form."""
    sets, of = scene.joint_sets, of_all(found.partition.blocks, found.across, "joint_set")[contact]
    etas = set_time_constants(scene)
    tension = np.array([one.tension is not False for one in sets])[of]
    normal, shear = (
        np.array([getattr(one, key) for one in sets], dtype=float)[of]
        for key in ("normal_stiffness", "shear_stiffness")
    )
    return law(
        normal,
        None if etas is None else etas[of],
        tension,
        shear_stiffness=shear,
        **strength_of(sets, of).strengths(),
    )


def _carried(scene: RockMass, found: PlaneDiscrete, contact: np.ndarray) -> np.ndarray | None:
    """Return the tractions [2, q] that a prestress puts on contacts, on block j and along the
    normal and its right: as `Jumps` has them; None without."""
    if scene.prestress is None:
        return None
    n = of_all(found.partition.blocks, found.across, "normal")[contact].T
    xx, yy, xy = stress_of(scene)
    t = np.array([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]])
    return np.array([(t * n).sum(axis=0), t[0] * n[1] - t[1] * n[0]])
