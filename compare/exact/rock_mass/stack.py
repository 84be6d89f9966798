"""The parallel joints of a scene as a stack of unbounded joints, and the conditions for that.

Valid for undamped rock with linear joints, region boundaries and a free face, all parallel and
continuous, in a convex domain with other sides through which waves leave, from rest: at t = 0 no
pulse may have met a joint in the domain.
"""

from dataclasses import dataclass

import numpy as np

from jointwave.cases.errors import placed
from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.incident import PlaneWave, plane_wave
from jointwave.cases.material.effective_medium import closed_stiffness
from jointwave.cases.material.rock import ElasticRock, elastic_rock
from jointwave.cases.material.rock_mass import initial_stress, set_time_constants
from jointwave.cases.partition.joints import rocks_of, strata
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import TOLERANCE, shape_of
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.pulse import Wave
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.plane import parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.parallel_joints import PulseStack
from jointwave.compare.exact.plane.waves import ACROSS, slownesses_across
from jointwave.compare.exact.rock_mass.conditions import (
    ALONG,
    all_parallel,
    along,
    free_face,
    linear_rock,
    normals_of,
    waves_leave,
)
from jointwave.compare.solvers.record import Answer

BEGUN = 1e-6  #: tolerated time since a pulse met a joint at t = 0, over the duration
FAINT = 1e-12  #: part of an S wave in or across its plane of incidence that is neglected


@dataclass(frozen=True)
class JointStack:
    """Parallel joints in rock; welded region boundaries are joints of infinite stiffness, a free
    face is a joint of zero stiffness.

    rocks : of the layers, along the normal [N + 1]. normal : unit vector across the joints [d].
    offsets : of the joints along the normal from the origin, ascending, m, [N]. joints : [N].
    blocks : of the domain. has_face : whether one of the joints is a free face.
    """

    rocks: list[ElasticRock]
    normal: np.ndarray
    offsets: np.ndarray
    joints: list[Joint]
    blocks: Blocks
    has_face: bool = False

    def met_by(self, wave: PlaneWave) -> list[PulseStack]:
        """Return the joints in the order in which a wave meets them, from its point `through`; for
        an S wave in space one stack each for its parts in the plane of incidence and across it."""
        along_travel = abs(wave.direction @ wave.polarisation) > 0.5
        kinds = ("P",) if along_travel else ("SV", *ACROSS)[: len(self.normal) - 1]
        offsets = self.offsets - wave.through @ self.normal
        by = self.normal, offsets, wave.polarisation
        found = (
            parallel_joints.stack_of(self.rocks, self.joints, kind, wave.direction, *by)
            for kind in kinds
        )
        return [one for one in found if np.abs(one.axes.incident).max() > FAINT]


def stack_of(scene: RockMass) -> JointStack:
    """Return the stack of a scene with parallel joints and any free face parallel to them; joints
    that are not linear have their stiffness under the initial stress."""
    blocks, face = blocks_of_scene(scene), free_face(scene)
    normal = next(iter(normals_of(scene)), None)
    if normal is None:
        assert face is not None
        normal = face.normal
    face = face if face is not None and along(face.normal, normal) else None
    contacts, etas = blocks.contacts, set_time_constants(scene)
    etas = np.zeros(len(scene.joint_sets)) if etas is None else etas
    depths, region = contacts.centroid @ normal, blocks.body.region[contacts.blocks]
    order = np.argsort(depths)
    met = (contacts.joint_set != NO_SET) | (region[:, 0] != region[:, 1])
    order = order[met[order]]
    apart = np.diff(depths[order], prepend=-np.inf)  # an opening may cut a joint into parts
    order = order[apart > TOLERANCE * np.ptp(blocks.body.vertices, axis=0).max()]
    joints = [
        Joint(np.inf, np.inf) if k == NO_SET else _joint(scene.joint_sets[k], etas[k], stress)
        for k, stress in zip(
            contacts.joint_set[order], initial_stress(scene, contacts.centroid[order]), strict=True
        )
    ]
    below, above = region[order].T
    swap = contacts.normal[order] @ normal < 0
    below, above = np.where(swap, above, below), np.where(swap, below, above)
    known = [elastic_rock(one) for one in rocks_of(scene)]
    rocks = [known[k] for k in (*below[:1], *above)] or [elastic_rock(scene.rock)]
    offsets, at = depths[order], 0
    if face is not None:
        along_normal = float(face.normal @ normal)
        at = len(joints) if along_normal > 0 else 0
        offsets = np.insert(offsets, at, face.offset * along_normal)
        joints.insert(at, Joint(0.0, 0.0))
        rocks.insert(at, rocks[at])
    return JointStack(rocks, normal, offsets, joints, blocks, face is not None)


def _joint(one: JointSet, eta: float, stress: np.ndarray) -> Joint:
    """Return a joint for small waves under a stress [d, d], Pa; eta : of its dashpots, s."""
    K_n, K_s = one.normal_stiffness or 0.0, one.shear_stiffness or 0.0
    return Joint(closed_stiffness(one, stress), K_s, K_n * eta, K_s * eta)


def scatters(scene: RockMass, leaves: bool = True) -> Answer:
    """Return whether incident waves and joints form the field of a stack, to which other loads and
    openings add. leaves : whether waves must leave through the sides."""
    normals, face = normals_of(scene), free_face(scene)
    if normals and face is not None and not along(face.normal, normals[0]):
        face = None
    outlined = len(strata(scene.regions)) < len(scene.regions)
    filed = scene.in_space and scene.domain.given is not None
    reasons = [
        (filed, "the domain is that of a file"),
        (outlined, "a region has an outline"),
        (not normals and face is None, "there is no joint"),
        (not all_parallel(scene), "joints are not parallel"),
    ]
    for i, wave in enumerate(scene.waves):
        runs_along = any(abs(n @ np.array(wave.direction)) < ALONG for n in normals)
        reasons.append((runs_along, f"waves[{i}] travels along the joints"))
        decays = bool(scene.regions and normals) and _decays(scene, wave)
        reasons.append((decays, f"waves[{i}] has an evanescent wave in a region"))
    if not leaves:
        return Answer.unless(*reasons)
    convex = len(shape_of(scene.domain).solids) <= len(scene.domain.holes)
    answer = linear_rock(scene) and Answer.unless(*reasons) and waves_leave(scene, face)
    return answer and Answer.unless((not convex, "the domain is not convex"))


def _decays(scene: RockMass, wave: Wave) -> bool:
    """Return whether a wave scattered at parallel boundaries is evanescent in some layer."""
    rocks = [elastic_rock(one) for one in rocks_of(scene)]
    return _slownesses(plane_wave(scene, wave), normals_of(scene)[0], rocks).min() <= 0


def _slownesses(wave: PlaneWave, n: np.ndarray, rocks: list[ElasticRock]) -> np.ndarray:
    """Return the slownesses across the joints of all scattered waves in each rock, s/m [rocks,
    kinds], 0 where these are evanescent. SH waves, which move along the joints, scatter no P."""
    p = float(np.linalg.norm(wave.direction - (wave.direction @ n) * n)) / wave.speed
    first = int(abs(wave.polarisation @ n) <= FAINT)
    return np.array([slownesses_across(one, p).real[first:] for one in rocks])


def begins_before(scene: RockMass, stack: JointStack) -> Answer:
    """Return whether no pulse has met a joint in the domain before the start, or which one has."""
    for i, wave in enumerate(scene.waves):
        incident = plane_wave(scene, wave)
        late = first_scattered(stack, incident)
        if late < -BEGUN * scene.time.duration:
            place = incident.through + late * incident.speed * incident.direction
            return Answer(
                f"waves[{i}] reaches a joint before t = 0: move it back, to "
                f"waves[{i}].through = {placed(place)} or further"
            )
    return Answer()


def first_scattered(stack: JointStack, wave: PlaneWave) -> float:
    """Return the first arrival of a reflected or transmitted wave in the domain, s.

    With the slownesses p along the joints and q across them, and the first joint's depth d, it is p
    x + q d + min(q_p, q_s) |z - d|. Evanescent waves count from the joint that generates them.
    """
    n = stack.normal if wave.direction @ stack.normal > 0 else -stack.normal
    across = float(wave.direction @ n)
    along = (wave.direction - across * n) / wave.speed
    q, least = across / wave.speed, _slownesses(wave, n, stack.rocks).min()
    places = stack.blocks.body.vertices - wave.through
    first = ((stack.offsets * (n @ stack.normal)) - wave.through @ n).min()
    return float((places @ along + q * first + least * np.abs(places @ n - first)).min())
