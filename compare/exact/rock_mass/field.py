"""The incident field of a scene, which acts on all quiet sides.

It is the field of the scene's parallel planes: joints with their initial stiffness, boundaries of
layers and a free face. If joints cross and all have a spacing, it is that of plane waves in their
effective medium, since the rock beyond transmits no wave of intact rock; otherwise that of waves in
intact rock. A single joint that stiffens or slips at normal incidence has its own exact field.

The field is exact if the scene has only these planes and joints stay linear: errors inside are then
the engine's own. 1000 points and 2000 times of one joint take about 0.5 s of CPU time, 1 s with
evanescent P waves.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointwave.cases import incident
from jointwave.cases.errors import SceneError
from jointwave.cases.partition.joints import strata
from jointwave.cases.partition.shape import SIDES, shape_of
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import REST, Boundaries, Region, RockMass
from jointwave.compare.exact.plane import layer_pulses
from jointwave.compare.exact.rock_mass import normal_incidence
from jointwave.compare.exact.rock_mass.conditions import (
    ALONG,
    PARALLEL,
    along,
    free_face,
    normals_of,
)
from jointwave.compare.exact.rock_mass.effective_medium import medium_field
from jointwave.compare.exact.rock_mass.normal_incidence import NormalField
from jointwave.compare.exact.rock_mass.stack import JointStack, scatters, stack_of


@dataclass(frozen=True)
class StackField:
    """The waves of a scene with all reflections and transmissions at its parallel planes."""

    stack: JointStack
    waves: tuple[incident.PlaneWave, ...]

    def __call__(self, points: np.ndarray, times: np.ndarray) -> incident.WaveMotion:
        m, dim = np.shape(points)
        total = [np.zeros((m, count, len(times))) for count in (dim, dim * (dim + 1) // 2)]
        for wave in self.waves if m else ():
            for met in self.stack.met_by(wave):
                found = layer_pulses.motion(wave.pulse.value, met, points - wave.through, times)
                for sum_, part in zip(total, found, strict=True):
                    sum_ += part
        return incident.WaveMotion(*total)


def field_of(scene: RockMass) -> incident.IncidentField:
    """Return the field of a scene's waves on quiet sides. Raises SceneError if it is unknown."""
    if not scene.waves:
        return incident.free_field(scene)
    if normal_incidence.applies(scene):
        return NormalField(scene)
    planes = planes_of(scene)
    waves = tuple(incident.plane_wave(scene, one) for one in scene.waves)
    if planes.joint_sets or planes.regions:
        return StackField(stack_of(planes), waves)
    if scene.joint_sets and all(one.spacing for one in scene.joint_sets):
        return medium_field(scene)
    if free_face(planes) is not None:
        return StackField(stack_of(planes), waves)
    return incident.FreeField(waves)


def _planes_in_space(scene: RockMass) -> RockMass:
    """Return a scene in space if all of its planes form a stack, else without them. Raises
    SceneError if single joints, other rock or sides reflect waves otherwise."""
    sides, of = SIDES[3][: 6 + (scene.domain.given is not None)], scene.boundaries
    known, face = scatters(scene, leaves=False), free_face(scene)
    normals, shape = normals_of(scene), shape_of(scene.domain)
    if not known or (face is not None and normals and not along(face.normal, normals[0])):
        face = None

    def in_stack(side: str) -> bool:
        outward = (n for _, n in shape.faces_of(side))
        return face is not None and any(n @ face.normal > 1 - PARALLEL for n in outward)

    back = [x for x in sides if getattr(of, x) in ("free", "fixed") and not in_stack(x)]
    quiet, why = [x for x in sides if getattr(of, x) == "quiet"], None
    if scene.regions and not known:
        why = f"regions, where {known.reason}"
    elif not known and not all(one.spacing for one in scene.joint_sets):
        why = "joints that are alone"
    elif any(sides.index(one) // 2 != sides.index(other) // 2 for one in back for other in quiet):
        why = f"a side that sends them back, {back[0]}, beside quiet ones"
    if why:
        allowed = f"meet {why}: their field is not known in space yet"
        raise SceneError(scene.where, "waves", len(scene.waves), allowed)
    return scene if known else scene.model_copy(update={"joint_sets": [], "regions": []})


def planes_of(scene: RockMass) -> RockMass:
    """Return a scene reduced to joints, region boundaries and a free face that form a stack of
    parallel planes. Raises SceneError if the waves between the remaining layers are unknown.

    In the plane, joints that cross layers, are not parallel or vary along periodic sides are left
    out; so is a free face not parallel to layers, or, without layers, joints not parallel to the
    face.
    """
    if scene.in_space:
        return _planes_in_space(scene)
    layers, sets = strata(scene.regions), _in_layers(scene)
    planes = scene.model_copy(update={"regions": layers, "joint_sets": []})
    if layers:
        if not (answer := scatters(planes, leaves=False)):
            allowed = f"enter regions in which their field is not known: {answer.reason}"
            raise SceneError(scene.where, "waves", len(scene.waves), allowed)
        sets = [one for one in sets if along(one.normal, normals_of(planes)[0])]
    face, cuts = free_face(scene), list[JointSet | Region]([*layers, *sets])
    normals = [one.normal for one in cuts]
    runs_along = any(abs(n @ one.direction) < ALONG for one in scene.waves for n in normals)
    sides = {side: "quiet" for side in scene.boundaries.sides("periodic")}
    repeats = [axis for axis, side in enumerate(("left", "bottom")) if side in sides]
    if face is not None and not all(along(face.normal, n) for n in normals):
        if layers:
            sides = dict.fromkeys(Boundaries.model_fields, "quiet")
        else:
            sets = []
    parallel = all(along(*pair) for pair in pairwise(normals)) and all(
        abs(n[axis]) < PARALLEL for n in normals for axis in repeats
    )
    if not layers and (runs_along or not parallel):
        sets = []
    if sets == scene.joint_sets and layers == scene.regions and not sides:
        return scene
    changes = {"joint_sets": sets, "boundaries": scene.boundaries.model_copy(update=sides)}
    if len(sets) < len(scene.joint_sets):  # the openings may need these joints for convex blocks
        changes["domain"] = Domain(outline=scene.domain.corners, non_convex="cut")
    return planes.model_copy(update=changes)


def _in_layers(scene: RockMass) -> list[JointSet]:
    """Return the joint sets of a scene, restricted to layers; none if a mesh gives the joints."""
    names = {REST, *(one.name for one in strata(scene.regions))}
    if scene.domain.given is not None:
        return []
    found = []
    for one in scene.joint_sets:
        inside = [name for name in one.regions if name in names] if one.regions else one.regions
        if inside or not one.regions:
            found.append(one.model_copy(update={"regions": inside}))
    return found
