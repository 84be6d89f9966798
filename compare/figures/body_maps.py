"""Maps of a quantity over a body, from the snapshots of results."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import label_of
from jointwave.compare.figures.animation import snapshots
from jointwave.compare.figures.animation.bodies import Body, body_of
from jointwave.compare.figures.animation.snapshots import Quantity, ViewSettings
from jointwave.compare.figures.drawing.plane import seen
from jointwave.compare.figures.section import Section, cut_cells, cut_joints, section_of
from jointwave.results.snapshots import snapshots_of

#: Tables that do not affect geometry, and a load to replace one whose file may be missing.
ASIDE = ("waves", "loads", "boundaries", "gravity", "prestress", "expect")
LOAD = dict.fromkeys(("cycles", "rise", "decay", "file"))
LOAD |= {"shape": "sine", "amplitude": 1.0, "period": 1.0}
PIECES = 150  # pieces of a joint as long as the body
CLOSE = 1e-6  # of the body's size: offset from a joint, and tolerance between sizes of bodies


class Map(NamedTuple):
    """A map of a quantity over a body, in coordinates (right, up) of the picture, m.

    corners : of faces [faces, corners, 2]. joints : pieces of joints [pieces, 2, 2]. values : of
    the faces or, for slip, of the pieces, in the unit of the quantity. time : of the snapshot, s;
    None for the peak over all. axes : their names. stretch : factor of the upward coordinate.
    section : of a body in space.
    """

    corners: np.ndarray
    joints: np.ndarray
    values: np.ndarray
    time: float | None
    quantity: Quantity
    axes: tuple[str, str]
    stretch: float
    section: Section | None = None

    @property
    def words(self) -> list[str]:
        """The section and the instant, where there are any."""
        at = [] if self.time is None else [f"at {1e3 * self.time:.4g} ms"]
        return [self.section.name, *at] if self.section else at

    @property
    def sizes(self) -> np.ndarray:
        """The areas of the faces, m2, or for slip the lengths of the pieces of joints, m."""
        if self.quantity == snapshots.SLIP:
            return np.linalg.norm(self.joints[:, 1] - self.joints[:, 0], axis=1)
        return shapely.area(shapely.polygons(self.corners))


def scene_of(result: xr.Dataset) -> AnyScene:
    """Return the scene of a result, without its loads, waves and boundaries. Raises SceneError if
    the file of its blocks or mesh is not where it was."""
    tables = json.loads(result.attrs["scene"])
    tables = {key: value for key, value in tables.items() if key not in ASIDE}
    tables["record"]["fields"] = None
    if "domain" in tables:
        size, mesh, blocks = (tables["domain"][key] for key in ("size", "mesh", "blocks"))
        folder = Path(result.attrs.get("folder", "."))
        if (file := blocks or mesh) is not None and not (folder / file).is_file():
            key = "domain.blocks" if blocks else "domain.mesh"
            raise SceneError(tables["title"], key, str(folder / file), "is not there any more")
        context = {"folder": folder, "dimension": len(size or "xy"), "asked": {"domain"}}
        return RockMass.model_validate(tables, context=context)
    return Scene.model_validate(tables | {"load": tables["load"] | LOAD})


def maps_of(
    scene: AnyScene,
    results: Sequence[xr.Dataset],
    quantity: str,
    time: float | None = None,
    section: str | None = None,
) -> dict[str, Map]:
    """Return the maps of results of the same body, by name; raises SceneError as `plot_map`."""
    stress = snapshots.quantities_of(scene)["stress"]
    known = {"ppv": snapshots.PEAK, "speed": snapshots.SPEED}
    known |= {"stress": stress, "slip": snapshots.SLIP}
    if quantity not in known:
        raise SceneError(scene.title, "map", quantity, f"must be one of {', '.join(known)}")
    if quantity == "ppv" and time is not None:
        why = "is of one instant, ppv the largest of all: choose speed, stress or slip"
        raise SceneError(scene.title, "time", time, why)
    plane = section_of(scene, section) if scene.in_space else None
    if section is not None and plane is None:
        raise SceneError(scene.title, "section", section, "is of a rock mass in space")
    engines, variants = ([str(one.attrs[key]) for one in results] for key in ("engine", "variant"))
    called = list(map(label_of, engines))
    for more in (variants, [str(k + 1) for k in range(len(called))]):
        if len(set(called)) < len(called):
            called = [", ".join(filter(None, both)) for both in zip(called, more, strict=True)]
    found: dict[str, Map] = {}
    for result, name in zip(results, called, strict=True):
        found[name] = one = _map(scene, result, known[quantity], time, plane)
        time = time if one.time is None else one.time
    ends = [(one.corners.min((0, 1)), one.corners.max((0, 1))) for one in found.values()]
    for end in ends[1:]:
        if not np.allclose(ends[0], end, rtol=0.0, atol=CLOSE * np.ptp(ends[0])):
            raise SceneError(scene.title, "", None, "the two results are of different bodies")
    return found


def _map(
    scene: AnyScene,
    result: xr.Dataset,
    quantity: Quantity,
    time: float | None,
    section: Section | None,
) -> Map:
    """Return the map of a result's snapshot nearest to a time (None: the one with the largest
    values); for the peak over all snapshots."""
    s = snapshots_of(result)
    if s is None or (s.stress is None and quantity == snapshots.quantities_of(scene)["stress"]):
        why = "is needed for a map: the result has no snapshots"
        raise SceneError(scene.title, "record.fields", None, why)
    view = snapshots.settings_for(scene, {"": s})
    if section is not None:
        across, upwards = np.eye(3)[section.axes]
        s, view = cut_cells(s, section), view._replace(right=across, up=upwards)
    body = body_of(s, view._replace(scale=1.0, stretch=1.0, quantity=quantity)).front()
    corners, values = body.rest[body.faces][..., [0, 2]], body.values
    joints, normals = _joints(scene, view, section)
    if quantity == snapshots.SLIP:
        if not len(joints) or not scene.is_spatial:
            why = "is of joints along which something moves; this body has none"
            raise SceneError(scene.title, "map", "slip", why)
        if "field_slip" in result:
            # Slip of rigid blocks; displacement jumps would include the strain of the rock.
            lines = shapely.linestrings(result["field_joints"].values[..., :2])
            middle = shapely.points(joints.mean(axis=1))
            nearest = shapely.STRtree(lines).query_nearest(middle, all_matches=False)[1]
            slip = np.abs(result["field_slip"].values[:, nearest])
        else:
            slip = _slip(body, corners, joints, normals)
        values = quantity.factor * slip
    right, up = ("xyz"[axis] for axis in (section.axes if section else (0, 1)))
    axes = ("y", "") if view.side else (right, up)
    found = Map(corners, joints, values[0], None, quantity, axes, view.stretch, section)
    if quantity == snapshots.PEAK:
        return found
    if time is None:
        i = int((values**2 @ found.sizes).argmax())
    else:
        i = int(np.abs(s.time - time).argmin())
        if not abs(s.time[i] - time) <= (s.time[-1] - s.time[0]) / max(1, len(s.time) - 1):
            allowed = f"must be from {s.time[0]:g} to {s.time[-1]:g} s"
            raise SceneError(scene.title, "time", time, allowed)
    return found._replace(values=values[i], time=float(s.time[i]))


def _joints(
    scene: AnyScene, view: ViewSettings, section: Section | None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the joints of a scene, cut into pieces [n, 2, 2], in coordinates of the picture, m,
    and the unit normal of each in its axes (right, away, up) [n, 3]."""
    if section is None:
        blocks, turn = seen(scene)
        ends = blocks.contacts.ends[blocks.contacts.joint_set >= 0][..., turn]
        right, up = np.diff(ends, axis=1)[:, 0].T
        normals = np.stack([-up, 0 * up, right], axis=1)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    else:
        ends, normals = cut_joints(scene, section)
        normals = normals @ np.stack([view.right, np.cross(view.up, view.right), view.up], axis=1)
    longest = float(np.ptp(ends, axis=(0, 1)).max()) / PIECES if len(ends) else 1.0
    lines = shapely.segmentize(shapely.linestrings(ends), longest)
    places, line = shapely.get_coordinates(lines, return_index=True)
    same = line[1:] == line[:-1]
    return np.stack([places[:-1], places[1:]], axis=1)[same], normals[line[1:][same]]


def _slip(body: Body, corners: np.ndarray, joints: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Return the magnitude of slip [snapshots, pieces], m: the tangential displacement jump between
    both sides of a joint, with displacements linear over each face."""
    across = normals[:, [0, 2]]
    beside = CLOSE * np.ptp(corners) * across / np.linalg.norm(across, axis=1, keepdims=True)
    moved = []
    for at in (joints.mean(axis=1) - beside, joints.mean(axis=1) + beside):
        face = _nearest(corners, at)
        middle = corners[face].mean(axis=1, keepdims=True)
        slopes = np.linalg.pinv(corners[face] - middle)  # [n, 2, corners]
        weights = 1 / corners.shape[1] + np.einsum("nd,ndk->nk", at - middle[:, 0], slopes)
        moved.append(np.einsum("tnkc,nk->tnc", body.motion[:, body.faces[face]], weights))
    jump = moved[1] - moved[0]
    opening = np.einsum("tnc,nc->tn", jump, normals)[..., None] * normals
    return np.linalg.norm(jump - opening, axis=2)


def _nearest(corners: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the indices of the faces that contain points [n, 2]."""
    tree = shapely.STRtree(shapely.polygons(corners))
    return tree.query_nearest(shapely.points(at), all_matches=False)[1]


def difference(one: Map, other: Map) -> Map:
    """Return the second map minus the first, on the faces of the finer map."""
    if one.quantity == snapshots.SLIP:
        return one._replace(values=other.values - one.values)
    finer = max(other, one, key=lambda of: len(of.corners))
    faces = finer.corners.mean(axis=1)
    ours, theirs = (of.values[_nearest(of.corners, faces)] for of in (one, other))
    return finer._replace(values=theirs - ours)
