"""Plane waves at parallel joints in space as waves in the plane.

A P wave, and an S wave that moves rock in the plane of its direction n and of the joints' normal m,
moves rock in that plane alone: along t, the part of n along the joints, and along m. It is the wave
of a scene in the plane, with t to the right and m upwards: a section. Across it strain is zero, so
that stress there is nu times that of both axes. Waves of several such planes add.

Valid for equally spaced or single joints, boundaries of regions and a free face, all parallel.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from shapely import MultiPoint

from jointwave.cases.geometry.measure import frames
from jointwave.cases.geometry.solids import corners_of
from jointwave.cases.incident import across, in_components
from jointwave.cases.partition.joints import attitude
from jointwave.cases.partition.regions import region_at, rocks_of
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.plane import Boundaries, InSituStress
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import Wave
from jointwave.compare.exact.rock_mass.conditions import (
    PARALLEL,
    all_parallel,
    along,
    beyond_linear_rock,
    free_face,
    normals_of,
    prestress_of,
    reflecting_side,
)
from jointwave.compare.solvers.record import Answer

#: Waveforms by quantity, those of tractions, gaps and slips of joints, and bounds on their errors.
Records = tuple[Mapping[str, np.ndarray], Mapping[str, np.ndarray]]


class Section(NamedTuple):
    """A wave of a scene in space as a scene in the plane.

    scene : in the plane, with that wave alone. axes : unit vectors along its x and y and across it
    [3, 3]. faces : the free side of the scene in space that the wave meets along the joints.
    """

    scene: RockMass
    axes: np.ndarray
    faces: list[str]

    def vectors(self, values: np.ndarray) -> np.ndarray:
        """Return vectors [m, 2, n] of the plane in space [m, 3, n]."""
        return np.einsum("mkn,ki->min", values, self.axes[:2])

    def stresses(self, values: np.ndarray, poisson: np.ndarray) -> np.ndarray:
        """Return stresses xx, yy, xy [m, 3, n] of the plane in space [m, 6, n], in rock of these
        Poisson's ratios [m]."""
        return np.einsum("mkn,mki->min", values, self.units(poisson))

    def units(self, poisson: np.ndarray) -> np.ndarray:
        """Return the components in space of unit stresses xx, yy, xy of the plane [m, 3, 6]."""
        t, m, b = self.axes
        parts = np.outer(t, t), np.outer(m, m), np.outer(t, m) + np.outer(m, t)
        share = np.outer(poisson, in_components(np.outer(b, b)))
        found = np.tile([in_components(one) for one in parts], (len(poisson), 1, 1))
        found[:, :2] += share[:, None]
        return found


def against(scene: RockMass) -> str | None:
    """Return why the waves of a scene in space have no sections, None if they do."""
    normals, face = normals_of(scene), free_face(scene)
    scattered = any(one.scatter for one in scene.joint_sets)
    reasons = [
        (scene.domain.given is not None, "the domain is that of a file"),
        (not normals and face is None, "there is no joint"),
        (not all_parallel(scene), "joints are not parallel"),
        (scattered, "the spacing of joints is scattered"),
    ]
    if reason := next((why for there, why in reasons if there), None):
        return reason
    m = _normal(scene)
    for i, wave in enumerate(scene.waves):
        if wave.kind == "S" and abs(_axes(wave, m)[2] @ across(np.array(wave.direction), wave)) > (
            PARALLEL
        ):
            return f"waves[{i}] moves rock along the joints, across its plane of incidence"
    return None


def of_sections(scene: RockMass, applies: Callable[[RockMass], Answer]) -> Answer:
    """Return whether a solution holds in all sections of a scene, and waves leave its sides."""
    if reason := against(scene):
        return Answer(reason)
    sections, face = sections_of(scene), free_face(scene)
    if face is not None and not along(face.normal, _normal(scene)):
        face = None
    linear = [one.model_copy(update={"maximum_closure": None}) for one in scene.joint_sets]
    reason = beyond_linear_rock(scene.model_copy(update={"joint_sets": linear}))
    if reason := reason or reflecting_side(scene, face):
        return Answer(reason)
    answers = (applies(one.scene) for one in sections)
    return next((one for one in answers if not one), Answer())


def sections_of(scene: RockMass) -> list[Section]:
    """Return the sections of a scene in space, one for each wave."""
    m = _normal(scene)
    return [_section(scene, wave, _axes(wave, m)) for wave in scene.waves]


def summed(scene: RockMass, sections: list[Section], each: list[Records]) -> Records:
    """Return the records of a scene in space by those of its sections."""
    m = _normal(scene)
    up = m * np.sign(m[np.flatnonzero(np.abs(m) > PARALLEL)[-1]])  # else to the north, else east
    tangents = np.concatenate(frames(up[None])) * (up @ m)
    points = np.array(scene.record.points).reshape(-1, 3)
    poisson, still = poisson_at(scene, points), prestress_of(scene)[:, None]
    values: dict[str, np.ndarray] = {}
    errors: dict[str, np.ndarray] = {}
    for one, (found, off) in zip(sections, each, strict=True):
        to_axes, to_stress = one.axes[:2], one.units(poisson)
        share = -tangents @ one.axes[0]  # the tangent of a joint with its normal upwards is -t
        turned = np.vstack([[1.0, 0.0], np.outer(share, [0.0, 1.0])]).T
        apart = prestress_of(one.scene)[:, None]
        parts = {
            name: np.einsum("mnk,ki->mni", found[name], to_axes)
            for name in ("velocity", "displacement")
        }
        of_waves = found["stress"] - apart[:, 0]
        parts["stress"] = np.einsum("mnk,mki->mni", of_waves, to_stress)
        parts["traction"] = found["traction"] @ turned
        parts["gap"], parts["slip"] = found["gap"], found["slip"][..., None] * share
        bounds = {name: off[name] @ np.abs(to_axes) for name in ("velocity", "displacement")}
        bounds["stress"] = np.einsum("mk,mki->mi", off["stress"], np.abs(to_stress))
        bounds["traction"] = off["traction"] @ np.abs(turned)
        bounds["gap"], bounds["slip"] = off["gap"], off["slip"][:, None] * np.abs(share)
        for total, more in ((values, parts), (errors, bounds)):
            for name, part in more.items():
                total[name] = total[name] + part if name in total else part
    values["stress"] = values["stress"] + still[:, 0]
    return values, errors


def poisson_at(scene: RockMass, places: np.ndarray) -> np.ndarray:
    """Return Poisson's ratio of the intact rock at places [m, 3]."""
    each = np.array([one.intact_poisson for one in rocks_of(scene)])
    return each[region_at(scene.regions, places)]


def _normal(scene: RockMass) -> np.ndarray:
    """Return the normal of the parallel planes of a scene."""
    face = free_face(scene)
    return next(iter(normals_of(scene)), np.eye(3)[2] if face is None else face.normal)


def _axes(wave: Wave, m: np.ndarray) -> np.ndarray:
    """Return t, m and the direction across them [3, 3]; t such that an S wave of a section moves
    rock to the left of its travel."""
    n = np.array(wave.direction)
    t = n - (n @ m) * m
    moved = None if wave.kind == "P" else across(n, wave)
    if np.linalg.norm(t) < PARALLEL:
        t = np.eye(3)[np.abs(m).argmin()] if moved is None else moved
        t = t - (t @ m) * m
    t = t / np.linalg.norm(t)
    if moved is not None and moved @ ((n @ t) * m - (n @ m) * t) < 0:
        t = -t
    return np.array([t, m, np.cross(t, m)])


def _section(scene: RockMass, wave: Wave, axes: np.ndarray) -> Section:
    t_m, m, face = axes[:2], axes[1], free_face(scene)
    corners = MultiPoint(np.array(scene.domain.corners) @ t_m.T).convex_hull
    sides, faces = dict.fromkeys(Boundaries.model_fields, "quiet"), list[str]()
    if face is not None and along(face.normal, m):
        sides["top" if face.normal @ m > 0 else "bottom"] = "free"
        normals = shape_of(scene.domain).normals().items()
        faces = [side for side, n in normals if n[0] @ face.normal > 1 - PARALLEL]

    def flat(place: list[float] | None) -> list[float] | None:
        return None if place is None else (t_m @ place).tolist()

    level = {"dip": 0.0, "dip_direction": None}
    sets = [
        one.model_copy(update=level | {"through": flat(one.through), "ends_at": []})
        for one in scene.joint_sets
    ]
    layers = [
        one.model_copy(
            update=level
            | {"through": flat(one.through), "dip": 0.0 if attitude(one, 3)[0] @ m > 0 else 180.0}
        )
        for one in scene.regions
    ]
    record = {key: [flat(at) for at in getattr(scene.record, key)] for key in ("points", "joints")}
    at = {"direction": (t_m @ wave.direction).tolist(), "polarisation": None}
    changes = {
        "domain": Domain(outline=corners_of(corners).tolist()),
        "joint_sets": sets,
        "regions": layers,
        "waves": [wave.model_copy(update=at | {"through": flat(wave.through)})],
        "boundaries": scene.boundaries.model_copy(update=sides),
        "record": scene.record.model_copy(update=record),
        "loads": [],
        "gravity": None,
    }
    if scene.prestress is not None:
        xx, xy, _, yy = (t_m @ scene.prestress.tensor @ t_m.T).ravel().tolist()
        changes["prestress"] = InSituStress.model_construct(xx=xx, yy=yy, xy=xy, zz=None)
    return Section(scene.model_copy(update=changes), axes, faces)
